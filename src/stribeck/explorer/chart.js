// One chart on a canvas: axes, areas, lines, points, or the film of a ball as an image. The page of the explorer and the front
// page of the site draw with it. It is a classic script, since a page that is opened from a folder loads no modules.
//
// Options are {x, y, series, drag}; with drag, {name, scale}, the mark of the present point follows the pointer along the axis.
// The cursor is a layer of its own: no move of the pointer paints the chart. A mouse that is dragged over a chart zooms. An axis is {name, unit, low, high, log}. A series is {id, name, type, look, data}, quiet where the
// legend leaves it out and faint where it is old. Colours are the variables of chart.css, which follow light and dark.
"use strict";

const StribeckChart = (() => {
  const FONT = "Roboto, system-ui, sans-serif";
  const CLOSE = 24; // pixels: so far from the pointer a lonely point still belongs to it
  const MOVED = 8; // pixels: a shorter drag is a click
  const FILM = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"]; // From thin to thick, as in pictures

  const LOOKS = {
    main: { colour: "ink", width: 2.3 },
    other: { colour: "grey", width: 1.2, dash: [3, 3] },
    plain: { colour: "grey", width: 1.2, dash: [6, 4] },
    contact: { colour: "contact", width: 1.6, dash: [7, 3] },
    fluid: { colour: "fluid", width: 1.6, dash: [9, 3, 2, 3] },
    minimum: { colour: "mark", width: 1.5, dash: [2, 3] },
    doubtful: { colour: "contact", width: 6, dash: [2, 2] },
    spread: { colour: "ink", opacity: 0.14, width: 8 },
    point: { colour: "ink", fill: "point", symbol: "circle", size: 13, width: 2 },
  };
  for (const regime of ["boundary", "mixed", "hydrodynamic"]) LOOKS[regime] = { colour: regime };
  [[8, 4], [2, 3], [10, 3, 2, 3], [5, 2], [12, 4], [3, 6]].forEach((dash, i) => {
    LOOKS[`pin${i}`] = { colour: `pin${i}`, width: 1.8, dash };
  });
  ["circle", "diamond", "triangle"].forEach((symbol, i) => {
    LOOKS[`measured${i}`] = { colour: "ink", symbol, size: 7, width: 1.6 };
  });

  // Corners of the symbols of points that are no circles, in halves of their size.
  const CORNERS = { diamond: [[0, -1], [1, 0], [0, 1], [-1, 0]], triangle: [[0, -1], [1, 0.8], [-1, 0.8]] };

  const raised = (power) => String(power).replace("-", "⁻").replace(/[0-9]/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
  const short = (value, digits) => String(Number(value.toPrecision(digits)));
  const inWords = (value) => (value === 0 || Math.abs(value) >= 1e-3 ? short(value, 3) : String(Number(value.toPrecision(3)).toExponential()));

  function lengthOf(metres) {
    const [unit, name] = metres < 1e-6 ? [1e-9, "nm"] : metres < 1e-3 ? [1e-6, "µm"] : [1e-3, "mm"];
    return `${short(metres / unit, 3)} ${name}`;
  }

  // Powers of ten in one style, and what lies between them.
  function powerOf(value) {
    const low = Math.floor(Math.log10(value) + 1e-9);
    const part = Number((value / 10 ** low).toPrecision(2));
    if (low >= -2 && low <= 2 && part !== 1) return String(Number(value.toPrecision(2)));
    return part !== 1 ? `${part}·10${raised(low)}` : low === 0 ? "1" : low === 1 ? "10" : `10${raised(low)}`;
  }

  // Marks of an axis with labels, and those without.
  function ticksOf({ low, high, log }, room) {
    const inside = (value) => value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9);
    if (!log) {
      const rough = (high - low) / Math.max(room / 60, 3);
      const power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [5, 2, 1].find((each) => each * power <= 1.001 * rough);
      const first = Math.ceil(low / step - 1e-9);
      const count = Math.floor(high / step + 1e-9) - first + 1;
      return { major: Array.from({ length: count }, (_, i) => [(first + i) * step, short((first + i) * step, 6)]), minor: [] };
    }
    const [first, last] = [Math.floor(Math.log10(low) + 1e-9), Math.ceil(Math.log10(high) - 1e-9)];
    const every = Math.max(1, Math.ceil(((last - first) * 34) / room));
    const powers = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    let major = powers.filter((power) => power % every === 0).map((power) => 10 ** power);
    const isShort = major.filter(inside).length < 3;
    if (isShort) major = powers.flatMap((power) => [1, 2, 5].map((part) => part * 10 ** power));
    const minor = every > 1 ? [] : powers.flatMap((power) => [2, 3, 4, 5, 6, 7, 8, 9].map((part) => part * 10 ** power));
    const words = isShort && low >= 1e-2 && high <= 1e3 ? inWords : powerOf;
    return { major: major.filter(inside).map((value) => [value, words(value)]), minor: minor.filter(inside) };
  }

  // From values of an axis to pixels, and from a part of the axis to its value.
  function scaleOf({ low, high, log }, from, to) {
    if (!log) return (value) => from + ((to - from) * (value - low)) / (high - low);
    const factor = (to - from) / Math.log(high / low);
    return (value) => from + factor * Math.log(value / low);
  }
  const valueOn = ({ low, high, log }, part) => (log ? low * (high / low) ** part : low + part * (high - low));

  // 256 colours between those of a film, each as one number of four bytes.
  const filmColours = (() => {
    const bytes = new Uint8ClampedArray(4 * 256);
    for (let i = 0; i < 256; i++) {
      const place = (i / 255) * (FILM.length - 1), below = Math.min(Math.floor(place), FILM.length - 2);
      const [one, two] = [FILM[below], FILM[below + 1]].map((colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)));
      bytes.set([...one.map((part, k) => part + (place - below) * (two[k] - part)), 255], 4 * i);
    }
    return new Uint32Array(bytes.buffer);
  })();

  // Logarithms of the film row by row, from the middle line on to one side, as an image with a pixel for each place on both.
  function imageOf({ data, columns, low, high }) {
    const middle = data.length / columns - 1;
    const image = document.createElement("canvas");
    [image.width, image.height] = [columns, 2 * middle + 1];
    const brush = image.getContext("2d");
    const pixels = brush.createImageData(image.width, image.height);
    const whole = new Uint32Array(pixels.data.buffer);
    data.forEach((value, i) => {
      const part = Math.min(Math.max((value - low) / (high - low || 1), 0), 1);
      const row = Math.floor(i / columns), column = i % columns;
      whole[(middle - row) * columns + column] = whole[(middle + row) * columns + column] = filmColours[Math.round(255 * part)];
    });
    brush.putImageData(pixels, 0, 0);
    return image;
  }

  const PAINT = {
    bands({ data }, { brush, x, box, colour }) {
      for (const [low, high, regime] of data) {
        brush.fillStyle = colour(regime);
        brush.fillRect(x(low), box.top, x(high) - x(low), box.height);
      }
    },
    // After the grid, which would cross the letters.
    names({ data }, { brush, x, box, colour }) {
      [brush.textAlign, brush.fillStyle, brush.font] = ["center", colour("grey"), `italic 12px ${FONT}`];
      for (const [low, high, name] of data) {
        const from = Math.max(x(low), box.left), to = Math.min(x(high), box.left + box.width);
        if (brush.measureText(name).width < to - from) brush.fillText(name, 0.5 * (from + to), box.top + 12);
      }
    },
    area(series, { brush, x, y, colour }) {
      brush.fillStyle = colour(series.colour);
      brush.beginPath();
      for (const [one, two] of series.data) brush.lineTo(x(one), Math.min(y(two), 1e6)); // zero lies below a logarithmic axis
      brush.fill();
    },
    // Strips along the axis, hatched.
    hatch(series, { brush, x, box, colour }) {
      const foot = box.top + box.height, tall = 10;
      [brush.strokeStyle, brush.lineWidth] = [colour(series.colour), 1.2];
      for (const [low, high] of series.data) {
        brush.save();
        brush.beginPath();
        brush.rect(x(low), foot - tall, Math.max(x(high) - x(low), 2), tall);
        brush.clip();
        brush.beginPath();
        for (let at = x(low) - tall; at < x(high) + 2; at += 5) {
          brush.moveTo(at, foot);
          brush.lineTo(at + tall, foot - tall);
        }
        brush.stroke();
        brush.restore();
      }
    },
    text({ data, name }, { brush, x, y, box, colour }) {
      [brush.textAlign, brush.fillStyle, brush.font] = ["center", colour("grey"), `italic 12px ${FONT}`];
      const half = 0.5 * brush.measureText(name).width;
      for (const [one, two] of data) {
        if (x(one) - half >= box.left && x(one) + half <= box.left + box.width) brush.fillText(name, x(one), y(two));
      }
    },
    line(series, { brush, x, y, colour }) {
      [brush.strokeStyle, brush.lineWidth, brush.lineJoin] = [colour(series.colour), series.width, "round"];
      brush.setLineDash(series.dash ?? []);
      brush.beginPath();
      let broken = true;
      for (const [one, two] of series.data) {
        const [across, up] = [x(one), y(two ?? NaN)];
        if (two === null || !Number.isFinite(across + up)) broken = true;
        else if (broken) [broken] = [false, brush.moveTo(across, up)];
        else brush.lineTo(across, up);
      }
      brush.stroke();
    },
    points(series, { brush, x, y, colour }) {
      brush.fillStyle = series.fill ? colour(series.fill) : "transparent";
      [brush.strokeStyle, brush.lineWidth] = [colour(series.colour), series.width];
      for (const [one, two] of series.data) {
        const [across, up, r] = [x(one), y(two), 0.5 * series.size];
        brush.beginPath();
        if (series.symbol === "circle") brush.arc(across, up, r, 0, 2 * Math.PI);
        else for (const [i, j] of CORNERS[series.symbol]) brush.lineTo(across + i * r, up + j * r);
        brush.closePath();
        brush.fill();
        brush.stroke();
      }
    },
    film(series, { brush, box }) {
      const half = (0.5 * box.width) / (series.columns - 1); // the middles of the outer pixels lie on the edges
      brush.drawImage(imageOf(series), box.left - half, box.top - half, box.width + 2 * half, box.height + 2 * half);
    },
  };
  const BEHIND = ["bands", "area", "film"]; // the grid

  const isThere = ([across, up]) => Number.isFinite(across) && Number.isFinite(up);
  const isMark = ({ type, data }) => type === "line" && data.length === 2 && data[0][0] === data[1][0];
  // An area between a lower and an upper end over the axis, and not between two places on it.
  const isSpread = ({ type, quiet, data }) => type === "area" && !quiet && data[0]?.[0] !== data[1]?.[0];
  const linesOf = (series) => series.filter((each) => each.type === "line" && !each.quiet && !isMark(each));

  // What a line has at a place along the axis, between its two points there as it is drawn.
  function valueAt(data, at, x, y) {
    const i = data.findIndex((each, i) => i > 0 && isThere(each) && isThere(data[i - 1]) && (data[i - 1][0] - at) * (each[0] - at) <= 0);
    if (i < 1) return NaN;
    const [[from, low], [to, high]] = [data[i - 1], data[i]];
    const part = x.log ? Math.log(at / from) / Math.log(to / from) : (at - from) / (to - from);
    return y.log && low * high > 0 ? low * (high / low) ** part : low + part * (high - low);
  }

  // A place in a film, from the logarithms of one side of it.
  function filmAt({ data, columns }, across, up) {
    const last = columns - 1, place = (part) => Math.min(last, Math.max(0, Math.round(part * last)));
    return lengthOf(10 ** data[Math.abs(place(up) - last / 2) * columns + place(across)]);
  }
  const endsOf = ({ low, high, beyond }) => [lengthOf(10 ** low), `${beyond ? "≥ " : ""}${lengthOf(10 ** high)}`];

  // The chart as a table: its lines at the labels of the axis, and of a film at those of both.
  function tableOf({ x, y }, series, film) {
    const labels = (axis) => ticksOf(axis, 480).major.map(([value]) => value);
    if (film) {
      const part = (axis, value) => (value - axis.low) / (axis.high - axis.low);
      const rows = labels(y).reverse().map((up) => [up, ...labels(x).map((at) => filmAt(film, part(x, at), part(y, up)))]);
      return [[`y below, x across (${x.unit})`, ...labels(x)], ...rows];
    }
    const least = y.log ? 0 : 1e-4 * (y.high - y.low); // what lies between the nodes of a state is no truer
    const number = (value) => (Number.isFinite(value) ? inWords(Math.abs(value) < least ? 0 : value) : "–");
    const at = (place) => ({ type, data }) => {
      const ends = type === "line" ? [data] : [data, [...data].reverse()];
      return ends.map((each) => number(valueAt(each, place, x, y))).join(" to ").replace("– to –", "–");
    };
    const shown = [...linesOf(series), ...series.filter(isSpread)];
    const rows = labels(x).map((place) => [inWords(place), ...shown.map(at(place))]);
    return [[x.name, ...shown.map(({ name }) => name)], ...rows];
  }

  // The chart in a sentence.
  function wordsOf({ x, y }, series, film) {
    const there = (value) => `${inWords(value)} ${x.unit}`.trim();
    const found = [`${y.name} over ${x.name}`];
    if (film) found.push(`film from ${endsOf(film).join(" to ")}`);
    const [main] = linesOf(series).sort((one, two) => two.width - one.width);
    const points = main?.data.filter(isThere).sort(([, one], [, two]) => one - two) ?? [];
    if (points.length) {
      const [low, high] = [points[0], points.at(-1)].map(([at, value]) => `${inWords(value)} at ${there(at)}`);
      found.push(`${main.name} from ${low} to ${high}`);
    }
    for (const { type, name, data } of series) {
      if (type === "bands") found.push(...data.map(([low, high, regime]) => `${regime} from ${there(low)} to ${there(high)}`));
      else if (type === "hatch") found.push(...data.map(([low, high]) => `${name} from ${there(low)} to ${there(high)}`));
      else if (isMark({ type, data })) found.push(`${name} at ${there(data[0][0])}`);
      else if (type === "points" && data.length > 1) found.push(`${name}: ${data.length} points`);
      else if (type === "points") found.push(`${name} ${inWords(data[0][1])} at ${there(data[0][0])}`);
    }
    return found.join("; ");
  }

  function element(tag, attributes = {}, ...children) {
    const svg = ["svg", "path", "circle", "polygon"].includes(tag);
    const made = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  // What stands for a series in the legend.
  function sampleOf({ colour, width, opacity = 1, dash = [], symbol }) {
    const look = { fill: "none", stroke: `var(--${colour})`, "stroke-width": symbol ? 1.6 : width, "stroke-opacity": opacity };
    const corners = (CORNERS[symbol] ?? []).map(([i, j]) => `${11 + 4 * i},${5 + 4 * j}`).join(" ");
    const shape = symbol === "circle" ? element("circle", { cx: 11, cy: 5, r: 3.5, ...look })
      : symbol ? element("polygon", { points: corners, ...look })
      : element("path", { d: "M 0 5 H 22", "stroke-dasharray": dash.join(" "), ...look });
    return element("svg", { viewBox: "0 0 22 10", "aria-hidden": "true" }, shape);
  }

  return class StribeckChart {
    constructor(place, label) {
      Object.assign(this, { label, options: null, hidden: new Set(), asTable: false, size: [0, 0], colours: {} });
      this.legend = element("div", { class: "legend", role: "group", "aria-label": `Lines of: ${label}` });
      this.table = element("div", { class: "scrolled", role: "region", "aria-label": label, tabindex: 0, hidden: "" });
      this.canvas = element("canvas", { role: "img", "aria-label": label, tabindex: 0 });
      this.tip = element("div", { class: "tip", role: "status", hidden: "" });
      this.cursor = element("div", { class: "cursor", hidden: "" });
      this.band = element("div", { class: "band", hidden: "" });
      place.classList.add("chart");
      place.replaceChildren(this.legend, this.table, this.canvas, this.cursor, this.band, this.tip);
      place.chart = this;
      this.brush = this.canvas.getContext("2d");
      const on = (type, act) => this.canvas.addEventListener(type, act);
      on("pointerdown", (event) => this.press(event));
      on("pointermove", (event) => this.move(event));
      on("pointerup", (event) => this.release(event));
      on("dblclick", () => this.zoomTo(null));
      for (const type of ["pointerleave", "pointercancel", "blur"]) on(type, () => this.leave());
      this.canvas.addEventListener("keydown", (event) => this.walk(event));
      // The size is kept, as asking for it in every frame would lay out the page in the middle of it.
      new ResizeObserver(([{ contentRect }]) => {
        this.size = [contentRect.width, contentRect.height];
        this.paint();
      }).observe(this.canvas);
      const recoloured = new MutationObserver(() => {
        this.colours = {};
        this.paint();
      });
      for (const each of [document.documentElement, document.body]) recoloured.observe(each, { attributeFilter: ["class", "data-theme"] });
      document.fonts.ready.then(() => this.paint());
      this.followScreen();
    }

    // Another screen has other pixels, which no change of size tells.
    followScreen() {
      const changed = () => {
        this.paint();
        if (this.canvas.isConnected) this.followScreen();
      };
      matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`).addEventListener("change", changed, { once: true });
    }

    show(options) {
      if (options.x.name !== this.options?.x.name) this.zoom = null;
      this.options = { ...options, series: options.series.map((each) => ({ ...LOOKS[each.look ?? each.id], ...each })) };
      this.film = this.options.series.find(({ type }) => type === "film");
      const listed = this.options.series.filter(({ quiet, type }) => !quiet && !["bands", "text", "film"].includes(type));
      const looks = JSON.stringify(listed.map(({ name, look, id }) => [name, look ?? id]));
      if (looks !== this.looks) this.list(listed);
      this.looks = looks;
      this.paint();
      // A screen reader is told at rest.
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.tellAll(), 400);
      if (this.asTable) this.tellAll();
    }

    // The legend: each name hides its line and shows it again.
    list(listed) {
      const button = (words, isPressed, title, act, attributes, ...children) => {
        const made = element("button", { type: "button", title, "aria-pressed": isPressed(), ...attributes }, ...children, words);
        made.addEventListener("click", () => {
          act();
          made.setAttribute("aria-pressed", isPressed());
          this.paint();
          this.tellAll();
        });
        return made;
      };
      const names = listed.map((each) => button(each.name, () => !this.hidden.has(each.name), `Show or hide ${each.name}`,
        () => this.hidden.delete(each.name) || this.hidden.add(each.name), {}, sampleOf(each)));
      const table = button("table", () => this.asTable, "Picture or table", () => {
        this.asTable = !this.asTable;
        [this.table.hidden, this.canvas.hidden] = [!this.asTable, this.asTable];
      }, { class: "as-table", "aria-label": `As a table: ${this.label}` });
      this.whole = button("whole", () => false, "Show all again, as Escape and a double click do", () => this.zoomTo(null), { class: "whole" });
      this.whole.hidden = !this.zoom;
      this.legend.replaceChildren(...names, this.whole, table);
    }

    // The axes that are shown: a part of them after a zoom.
    get view() {
      const { x, y } = this.options;
      return { x: { ...x, ...this.zoom?.x }, y: { ...y, ...this.zoom?.y } };
    }

    zoomTo(zoom) {
      this.zoom = zoom;
      this.whole.hidden = !zoom;
      this.paint();
      this.tellAll();
    }

    shown() {
      return this.options.series.filter(({ name }) => !this.hidden.has(name));
    }

    // The chart as words, and as a table where that is wanted.
    tellAll() {
      if (!this.options) return;
      const words = wordsOf(this.view, this.shown(), this.film);
      this.canvas.setAttribute("aria-label", `${this.label}: ${words}; arrow keys read its values`);
      if (!this.asTable) return;
      const [head, ...rows] = tableOf(this.view, this.shown(), this.film);
      const row = ([first, ...others], scope, tag) =>
        element("tr", {}, element("th", { scope }, first), ...others.map((each) => element(tag, tag === "th" ? { scope } : {}, each)));
      this.table.replaceChildren(element("table", {}, element("caption", {}, words), row(head, "col", "th"), ...rows.map((each) => row(each, "row", "td"))));
    }

    paint() {
      const { brush, canvas, size: [width, height], film } = this, ratio = window.devicePixelRatio;
      if (!this.options || !width || !height) return;
      if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
      if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
      brush.setTransform(ratio, 0, 0, ratio, 0, 0);
      brush.clearRect(0, 0, width, height);
      const [left, bottom] = film ? [50, 84] : [62, 44], box = { left, top: 6, width: width - left - 16, height: height - 6 - bottom };
      if (film) box.width = box.height = Math.min(box.width, box.height);
      const { x, y } = this.view;
      const on = {
        brush, box, x: scaleOf(x, left, left + box.width), y: scaleOf(y, box.top + box.height, box.top),
        colour: (name) => (this.colours[name] ??= getComputedStyle(canvas).getPropertyValue(`--${name}`).trim()),
      };
      this.on = on;
      const part = (series, what = series.type) => {
        brush.save();
        brush.beginPath();
        // The mark of the present point may stand half outside.
        const room = what === "points" ? 0.5 * series.size + 1 : 0;
        brush.rect(box.left - room, box.top - room, box.width + 2 * room, box.height + 2 * room);
        brush.clip();
        brush.globalAlpha = series.faint ? 0.25 : (series.opacity ?? 1);
        PAINT[what](series, on);
        brush.restore();
      };
      const shown = this.shown();
      for (const each of shown) if (BEHIND.includes(each.type)) part(each);
      this.paintAxes(on);
      for (const each of shown) {
        if (each.type === "bands") part(each, "names");
        else if (!BEHIND.includes(each.type)) part(each);
      }
      if (film) this.paintScale(on, height);
      if (this.pointer) this.tell();
    }

    paintAxes({ brush, box, x, y, colour }) {
      const { view: { x: across, y: up }, film } = this, [right, foot] = [box.left + box.width, box.top + box.height];
      const stroke = (name, lines) => {
        [brush.strokeStyle, brush.lineWidth] = [colour(name), 1];
        brush.beginPath();
        for (const [a, b, c, d] of lines) {
          brush.moveTo(a, b);
          brush.lineTo(c, d);
        }
        brush.stroke();
      };
      const pixel = (value) => Math.round(value) + 0.5; // sharp
      const [down, along] = [ticksOf(up, box.height), ticksOf(across, box.width)];
      const vertical = along.major.map(([value]) => pixel(x(value)));
      const horizontal = down.major.map(([value]) => pixel(y(value)));
      if (!film) stroke("grid", [...vertical.map((at) => [at, box.top, at, foot]), ...horizontal.map((at) => [box.left, at, right, at])]);
      stroke("grey", [
        [box.left, pixel(foot), right, pixel(foot)], [pixel(box.left), box.top, pixel(box.left), foot],
        ...vertical.map((at) => [at, foot, at, foot + 5]), ...along.minor.map((value) => [pixel(x(value)), foot, pixel(x(value)), foot + 3]),
        ...horizontal.map((at) => [box.left - 5, at, box.left, at]), ...down.minor.map((value) => [box.left - 3, pixel(y(value)), box.left, pixel(y(value))]),
      ]);
      [brush.fillStyle, brush.font, brush.textBaseline, brush.textAlign] = [colour("grey"), `11px ${FONT}`, "middle", "center"];
      let end = -Infinity;
      for (const [value, words] of along.major) {
        const half = 0.5 * brush.measureText(words).width;
        if (x(value) - half < end + 4) continue;
        brush.fillText(words, x(value), foot + 14);
        end = x(value) + half;
      }
      brush.textAlign = "right";
      end = Infinity;
      for (const [value, words] of down.major) {
        if (y(value) + 6 > end) continue;
        brush.fillText(words, box.left - 8, y(value));
        end = y(value) - 7;
      }
      [brush.font, brush.textAlign] = [`12px ${FONT}`, "center"];
      brush.fillText(across.name, box.left + 0.5 * box.width, foot + 33);
      brush.save();
      brush.translate(film ? 12 : 11, box.top + 0.5 * box.height);
      brush.rotate(-0.5 * Math.PI);
      brush.fillText(up.name, 0, 0);
      brush.restore();
    }

    // The colours of a film, from thin to thick, with its ends in words.
    paintScale({ brush, box, colour }, height) {
      const [left, width, top] = [box.left + 60, box.width - 130, height - 16], [thin, thick] = endsOf(this.film);
      const run = brush.createLinearGradient(left, 0, left + width, 0);
      FILM.forEach((each, i) => run.addColorStop(i / (FILM.length - 1), each));
      brush.fillStyle = run;
      brush.fillRect(left, top, width, 11);
      [brush.fillStyle, brush.font, brush.textAlign] = [colour("grey"), `11px ${FONT}`, "right"];
      brush.fillText(thin, left - 6, top + 6);
      brush.textAlign = "left";
      brush.fillText(thick, left + width + 6, top + 6);
    }

    // Where the mark of the present point stands, if it can be dragged.
    handle() {
      const point = this.options?.drag && this.options.series.find(({ id }) => id === "point")?.data[0];
      return point && [this.on.x(point[0]), this.on.y(point[1])];
    }

    isOnHandle([across, up]) {
      const at = this.on && this.handle();
      return Boolean(at) && Math.hypot(at[0] - across, at[1] - up) < CLOSE;
    }

    press(event) {
      this.pointer = [event.offsetX, event.offsetY];
      this.held = this.isOnHandle(this.pointer) ? "point" : event.pointerType === "mouse" && !this.film ? this.pointer : null;
      if (this.held) this.canvas.setPointerCapture(event.pointerId);
      this.tell();
    }

    move(event) {
      this.pointer = [event.offsetX, event.offsetY];
      if (this.held === "point") {
        const { box } = this.on, { name, scale } = this.options.drag;
        const part = Math.min(Math.max((this.pointer[0] - box.left) / box.width, 0), 1);
        this.onDrag?.(name, Math.log10(valueOn(this.view.x, part) / scale));
      } else if (!this.held) this.canvas.style.cursor = this.isOnHandle(this.pointer) ? "grab" : "";
      this.tell();
    }

    release() {
      const { held, pointer, on: { box } } = this;
      this.held = null;
      this.band.hidden = true;
      if (!held || held === "point" || Math.abs(pointer[0] - held[0]) < MOVED) return;
      const inside = (value, from, size) => Math.min(Math.max((value - from) / size, 0), 1);
      const ends = (axis, parts) => {
        const [low, high] = parts.sort((one, two) => one - two).map((part) => valueOn(axis, part));
        return { low, high };
      };
      const { x, y } = this.view, [across, up] = [0, 1].map((i) => [held, pointer].map((place) => place[i]));
      const zoom = { x: ends(x, across.map((each) => inside(each, box.left, box.width))) };
      // A drag along the axis leaves the other axis as it is.
      if (Math.abs(up[0] - up[1]) > MOVED * 3) zoom.y = ends(y, up.map((each) => 1 - inside(each, box.top, box.height)));
      else zoom.y = this.zoom?.y;
      this.zoomTo(zoom);
    }

    // A readout by keyboard: arrow keys move it, with Shift faster, Escape removes it.
    walk(event) {
      const step = (event.shiftKey ? 40 : 8) * { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.key === "Escape") this.leave(this.zoom && this.zoomTo(null));
      if (!step || !this.on) return;
      event.preventDefault();
      const { left, width, top, height } = this.on.box, [across, up] = this.pointer ?? [left + 0.5 * width, top + 0.5 * height];
      this.pointer = [Math.min(Math.max(across + step, left), left + width), up];
      this.tell();
    }

    leave() {
      this.pointer = this.held = null;
      for (const each of [this.tip, this.cursor, this.band]) each.hidden = true;
    }

    // What is under the pointer, in words, beside a line there.
    tell() {
      if (!this.on || !this.pointer) return;
      const { on: { box, x }, tip, canvas, cursor, band, held, pointer: [across, up] } = this;
      const inside = across >= box.left && across <= box.left + box.width && up >= box.top && up <= box.top + box.height;
      const lines = inside ? this.under(box, x, across, up) : [];
      tip.hidden = lines.length === 0;
      cursor.hidden = tip.hidden || Boolean(this.film);
      band.hidden = !Array.isArray(held);
      const put = (part, left, top, width, height) =>
        Object.assign(part.style, { left: `${canvas.offsetLeft + left}px`, top: `${canvas.offsetTop + top}px`, width: `${width}px`, height: `${height}px` });
      put(cursor, across, box.top, 0, box.height);
      if (!band.hidden) put(band, Math.min(across, held[0]), box.top, Math.abs(across - held[0]), box.height);
      if (tip.hidden) return;
      tip.replaceChildren(...lines.map(([words, name]) => element("div", name ? { style: `--curve: var(--${name})` } : {}, words)));
      const beside = across + 14 + tip.offsetWidth > canvas.clientWidth ? across - 14 - tip.offsetWidth : across + 14;
      tip.style.left = `${canvas.offsetLeft + Math.max(0, beside)}px`;
      tip.style.top = `${canvas.offsetTop + Math.max(0, Math.min(up, canvas.clientHeight - tip.offsetHeight))}px`;
    }

    // Lines have a value everywhere; marks and measured points are told where they are near.
    under(box, x, across, up) {
      const part = (across - box.left) / box.width, { x: axis, y } = this.view, at = valueOn(axis, part);
      if (this.film) return [[`film ${filmAt(this.film, part, (up - box.top) / box.height)}`]];
      const found = [];
      for (const each of this.shown()) {
        const { type, name, data, colour } = each;
        if ((type !== "line" && type !== "points") || data.length === 0) continue;
        const away = ([one]) => Math.abs(x(one) - across);
        const near = data.reduce((best, each) => (away(each) < away(best) ? each : best));
        if (isMark(each)) {
          if (away(near) < CLOSE) found.push([`${name} at ${inWords(near[0])} ${axis.unit}`, colour]);
          continue;
        }
        const value = type === "line" && data.length > 2 ? valueAt(data, at, axis, y) : away(near) < CLOSE || type === "line" ? near[1] : null;
        if (Number.isFinite(value)) found.push([`${name} ${short(value, 4)} ${y.unit}`, colour]);
      }
      return found.length ? [[`${axis.name.replace(/ \(.*/, "")} ${short(at, 3)} ${axis.unit}`], ...found] : [];
    }
  };
})();
