// Shows one answer: what changed in the charts, the fields and the numbers. Returning tells the server that it is drawn.
window.explorerFrame = (frame) => {
  document.body.dataset.geometry = frame.geometry;
  document.body.classList.remove("working");
  for (const [id, html] of frame.html) document.getElementById(id).innerHTML = html;
  for (const [id, chart] of frame.charts) getElement(id)?.show(chart);
  for (const [id, now] of frame.knobs) getElement(id)?.show(now);
  explorerWaits(frame.waits);
  if (frame.moved) getElement(frame.moved)?.free();
  return true;
};

// The answer takes longer than a moment: what stands there is that of the contact before, but for the fields.
window.explorerWorking = (moved, knobs) => {
  document.body.classList.add("working");
  for (const [id, now] of knobs) getElement(id)?.show(now);
  if (moved) getElement(moved)?.free();
};

// What belongs to the contact before is pale until its own is there.
window.explorerWaits = (words) => {
  document.querySelector(".more .waits").textContent = words;
  document.querySelector(".more .margins").classList.toggle("old", words !== "");
};

const explorerSay = (message) => Quasar.Notify.create({ message, timeout: 6000, closeBtn: "Close" });

window.explorerUpload = async (input, tab) => {
  const files = [...input.files];
  input.value = "";
  for (const file of files) {
    const answer = await fetch(`/upload/${tab}?name=${encodeURIComponent(file.name.slice(-200))}`, { method: "POST", body: file })
      .catch(() => null);
    if (!answer?.ok) explorerSay(answer?.status === 413 ? await answer.text() : `${file.name} could not be sent; reload the page.`);
  }
};

window.explorerDownload = async (tab, kind) => {
  const answer = await fetch(`/download/${tab}/${kind}`).catch(() => null);
  if (!answer?.ok) {
    if (answer?.status !== 409) explorerSay("The file could not be made; reload the page.");
    return;
  }
  const anchor = document.createElement("a");
  anchor.href = URL.createObjectURL(await answer.blob());
  anchor.download = decodeURIComponent(answer.headers.get("x-file-name"));
  anchor.click();
  // At once would be too early: the browser may not have begun to read it.
  setTimeout(() => URL.revokeObjectURL(anchor.href), 60000);
};

window.explorerCopy = () => {
  const say = (message) => Quasar.Notify.create({ message, timeout: 1600 });
  const write = navigator.clipboard ? navigator.clipboard.writeText(location.href) : Promise.reject();
  write.then(() => say("Address copied"), () => say("The address bar holds the link"));
};

// Ctrl-Z also while a slider or a field that holds no new text has the focus; a field that is edited undoes its own letters.
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase();
  const way = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : "";
  if (!way) return;
  event.preventDefault();
  document.querySelector(`.history-${way}`)?.click();
});

document.documentElement.lang = "en";
