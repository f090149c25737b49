// Shows one answer: what changed in the charts, the fields and the numbers. Returning tells the server that it is drawn.
window.explorerFrame = (frame) => {
  document.body.dataset.geometry = frame.geometry;
  document.body.classList.remove("working");
  for (const [id, html] of frame.html) document.getElementById(id).innerHTML = html;
  for (const [id, options, settings] of frame.charts) getElement(id)?.chart?.setOption(options, settings);
  for (const [id, now] of frame.knobs) getElement(id)?.show(now);
  explorerWaits(frame.waits);
  window.explorerUnits = frame.units;
  if (frame.moved) getElement(frame.moved)?.free();
  return true;
};

// The answer takes longer than a moment: what stands there is that of the contact before.
window.explorerWorking = (moved) => {
  document.body.classList.add("working");
  if (moved) getElement(moved)?.free();
};

// What belongs to the contact before is pale until its own is there.
window.explorerWaits = (words) => {
  document.querySelector(".more .waits").textContent = words;
  document.querySelector(".more .ways").classList.toggle("old", words !== "");
};

// The film of a ball: logarithms of its height in metres row by row from below, as one image with a pixel for each place. The middles of
// the outer pixels lie on the edges.
let film = null;
window.explorerFilm = (heights, stops, { x, y, width, height }) => {
  const count = Math.sqrt(heights.length);
  const low = Math.min(...heights);
  const range = Math.max(...heights) - low || 1;
  const colours = stops.map((stop) => [1, 3, 5].map((at) => parseInt(stop.slice(at, at + 2), 16)));
  const image = document.createElement("canvas");
  image.width = image.height = count;
  const brush = image.getContext("2d");
  const pixels = brush.createImageData(count, count);
  heights.forEach((logarithm, i) => {
    const place = ((logarithm - low) / range) * (colours.length - 1);
    const below = Math.min(Math.floor(place), colours.length - 2);
    const pixel = 4 * ((count - 1 - Math.floor(i / count)) * count + (i % count));
    for (const c of [0, 1, 2]) {
      pixels.data[pixel + c] = colours[below][c] + (place - below) * (colours[below + 1][c] - colours[below][c]);
    }
    pixels.data[pixel + 3] = 255;
  });
  brush.putImageData(pixels, 0, 0);
  const beyond = 0.5 * (width / (count - 1));
  film = { heights, count, x, y, width, height };
  return { image, x: x - beyond, y: y - beyond, width: width + 2 * beyond, height: height + 2 * beyond };
};

// The film under the pointer, in words.
let pointer = null;
document.addEventListener("pointermove", (event) => (pointer = event), true);
window.explorerFilmAt = () => {
  const canvas = document.querySelector(".chart-plane canvas").getBoundingClientRect();
  const place = (part) => Math.min(film.count - 1, Math.max(0, Math.round(part * (film.count - 1))));
  const column = place((pointer.clientX - canvas.left - film.x) / film.width);
  const row = place(1 - (pointer.clientY - canvas.top - film.y) / film.height);
  const metres = Math.pow(10, film.heights[row * film.count + column]);
  const [unit, name] = metres < 1e-6 ? [1e-9, "nm"] : metres < 1e-3 ? [1e-6, "µm"] : [1e-3, "mm"];
  return `film ${Number((metres / unit).toPrecision(3))} ${name}`;
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
