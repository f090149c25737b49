// Shows one answer: what changed in the charts, the fields and the numbers. Returning tells the server that it is drawn.
window.explorerFrame = (frame) => {
  for (const [id, html] of frame.html) document.getElementById(id).innerHTML = html;
  for (const [id, options, settings] of frame.charts) getElement(id)?.chart?.setOption(options, settings);
  for (const [id, now] of frame.knobs) getElement(id)?.show(now);
  if (frame.moved) getElement(frame.moved)?.free();
  return true;
};

window.explorerCopy = () => {
  const say = (message) => Quasar.Notify.create({ message, timeout: 1600 });
  const write = navigator.clipboard ? navigator.clipboard.writeText(location.href) : Promise.reject();
  write.then(() => say("Address copied"), () => say("The address bar holds the link"));
};
