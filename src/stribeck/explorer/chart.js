// One chart on a canvas: axes, areas, lines, points, or the film of a ball as an image. Python sends what is drawn, as of
// charts/parts.py.
const FONT = "Roboto, system-ui, sans-serif";
const MARGIN = { left: 62, right: 16, top: 6, bottom: 44 };
const CLOSE = 24; // pixels: so far from the pointer a lonely point still belongs to it

const raised = (power) => String(power).replace("-", "⁻").replace(/[0-9]/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

// Powers of ten in one style, and what lies between them.
function powerOf(value) {
  const low = Math.floor(Math.log10(value) + 1e-9);
  const part = Number((value / 10 ** low).toPrecision(2));
  if (low >= -2 && low <= 2 && part !== 1) return String(Number(value.toPrecision(2)));
  return part !== 1 ? `${part}·10${raised(low)}` : low === 0 ? "1" : low === 1 ? "10" : `10${raised(low)}`;
}

const short = (value, digits) => String(Number(value.toPrecision(digits)));

// Marks of an axis with labels, and those without.
function ticksOf(axis, room) {
  const { low, high } = axis;
  const inside = (value) => value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9);
  if (!axis.log) {
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
  if (major.filter(inside).length < 3) major = powers.flatMap((power) => [1, 2, 5].map((part) => part * 10 ** power));
  const minor = every > 1 ? [] : powers.flatMap((power) => [2, 3, 4, 5, 6, 7, 8, 9].map((part) => part * 10 ** power));
  return { major: major.filter(inside).map((value) => [value, powerOf(value)]), minor: minor.filter(inside) };
}

// From values of an axis to pixels.
function scaleOf({ low, high, log }, from, to) {
  if (!log) return (value) => from + ((to - from) * (value - low)) / (high - low);
  const factor = (to - from) / Math.log(high / low);
  return (value) => from + factor * Math.log(value / low);
}

// 256 colours between some, each as one number of four bytes.
function scaleOfColours(colours) {
  const bytes = new Uint8ClampedArray(4 * 256);
  for (let i = 0; i < 256; i++) {
    const place = (i / 255) * (colours.length - 1);
    const below = Math.min(Math.floor(place), colours.length - 2);
    const part = (at, colour) => parseInt(colour.slice(at, at + 2), 16);
    const mixed = [1, 3, 5].map((at) => part(at, colours[below]) + (place - below) * (part(at, colours[below + 1]) - part(at, colours[below])));
    bytes.set([...mixed, 255], 4 * i);
  }
  return new Uint32Array(bytes.buffer);
}

// Logarithms of the film row by row, from the middle line on to one side, as an image with a pixel for each place on both.
let filmColours = null;
function imageOf({ data, columns, low, high, colours }) {
  filmColours ??= scaleOfColours(colours);
  const middle = data.length / columns - 1;
  const image = document.createElement("canvas");
  [image.width, image.height] = [columns, 2 * middle + 1];
  const brush = image.getContext("2d");
  const pixels = brush.createImageData(image.width, image.height);
  const whole = new Uint32Array(pixels.data.buffer);
  for (let row = 0, i = 0; row <= middle; row++) {
    for (let column = 0; column < columns; column++, i++) {
      const part = Math.min(Math.max((data[i] - low) / (high - low || 1), 0), 1);
      const colour = filmColours[Math.round(255 * part)];
      whole[(middle - row) * columns + column] = whole[(middle + row) * columns + column] = colour;
    }
  }
  brush.putImageData(pixels, 0, 0);
  return image;
}

function lengthOf(metres) {
  const [unit, name] = metres < 1e-6 ? [1e-9, "nm"] : metres < 1e-3 ? [1e-6, "µm"] : [1e-3, "mm"];
  return `${short(metres / unit, 3)} ${name}`;
}

// Corners of the symbols of points that are no circles, in halves of their size.
const CORNERS = { diamond: [[0, -1], [1, 0], [0, 1], [-1, 0]], triangle: [[0, -1], [1, 0.8], [-1, 0.8]] };

const PAINT = {
  bands({ data }, { brush, x, box }) {
    for (const [low, high, colour] of data) {
      brush.fillStyle = colour;
      brush.fillRect(x(low), box.top, x(high) - x(low), box.height);
    }
  },
  // After the grid, which would cross the letters.
  names({ data, grey }, { brush, x, box }) {
    [brush.textAlign, brush.fillStyle, brush.font] = ["center", grey, `italic 12px ${FONT}`];
    for (const [low, high, , name] of data) {
      if (brush.measureText(name).width < x(high) - x(low)) brush.fillText(name, 0.5 * (x(low) + x(high)), box.top + 12);
    }
  },
  area({ data, color, opacity }, { brush, x, y }) {
    brush.globalAlpha = opacity ?? 1;
    brush.fillStyle = color;
    brush.beginPath();
    for (const [one, two] of data) brush.lineTo(x(one), y(two));
    brush.fill();
  },
  // Strips along the axis, hatched.
  hatch({ data, color }, { brush, x, box }) {
    const foot = box.top + box.height, tall = 10;
    [brush.strokeStyle, brush.lineWidth] = [color, 1.2];
    for (const [low, high] of data) {
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
  text({ data, words, color }, { brush, x, y, box }) {
    [brush.textAlign, brush.fillStyle, brush.font] = ["center", color, `italic 12px ${FONT}`];
    const half = 0.5 * brush.measureText(words).width;
    for (const [one, two] of data) {
      if (x(one) - half >= box.left && x(one) + half <= box.left + box.width) brush.fillText(words, x(one), y(two));
    }
  },
  line({ data, color, width, dash, opacity }, { brush, x, y }) {
    brush.globalAlpha = opacity ?? 1;
    [brush.strokeStyle, brush.lineWidth, brush.lineJoin] = [color, width, "round"];
    brush.setLineDash(dash);
    brush.beginPath();
    let broken = true;
    for (const [one, two] of data) {
      const [across, up] = [x(one), y(two ?? NaN)];
      if (two === null || !Number.isFinite(across + up)) broken = true;
      else if (broken) [broken] = [false, brush.moveTo(across, up)];
      else brush.lineTo(across, up);
    }
    brush.stroke();
  },
  points({ data, fill, edge, width, size, symbol }, { brush, x, y }) {
    [brush.fillStyle, brush.strokeStyle, brush.lineWidth] = [fill, edge, width];
    for (const [one, two] of data) {
      const [across, up, r] = [x(one), y(two), 0.5 * size];
      brush.beginPath();
      if (symbol === "circle") brush.arc(across, up, r, 0, 2 * Math.PI);
      else for (const [i, j] of CORNERS[symbol]) brush.lineTo(across + i * r, up + j * r);
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

// What a line has at a place along the axis, between its two points there as it is drawn.
function valueAt(data, at, x, y) {
  const i = data.findIndex((each, i) => i > 0 && isThere(each) && isThere(data[i - 1]) && (data[i - 1][0] - at) * (each[0] - at) <= 0);
  if (i < 1) return NaN;
  const [[from, low], [to, high]] = [data[i - 1], data[i]];
  const part = x.log ? Math.log(at / from) / Math.log(to / from) : (at - from) / (to - from);
  return y.log ? low * (high / low) ** part : low + part * (high - low);
}

// A place in a film, from the logarithms of one side of it.
function filmAt({ data, columns }, across, up) {
  const last = columns - 1, place = (part) => Math.min(last, Math.max(0, Math.round(part * last)));
  return lengthOf(10 ** data[Math.abs(place(up) - last / 2) * columns + place(across)]);
}

const isMark = ({ type, data }) => type === "line" && data.length === 2 && data[0][0] === data[1][0];
const linesOf = ({ series, legend }) =>
  legend.map((name) => series.find((each) => each.name === name)).filter((each) => each?.type === "line" && !isMark(each));
const inWords = (value) => (value === 0 || Math.abs(value) >= 1e-3 ? short(value, 3) : String(Number(value.toPrecision(3)).toExponential()));

// The chart as a table: its lines at the labels of the axis, and of a film at those of both.
function tableOf(options) {
  const { x, y, series } = options;
  const labels = (axis) => ticksOf(axis, 480).major.map(([value]) => value);
  const film = series.find(({ type }) => type === "film");
  if (film) {
    const part = (axis, value) => (value - axis.low) / (axis.high - axis.low);
    const rows = labels(y).reverse().map((up) => [up, ...labels(x).map((at) => filmAt(film, part(x, at), part(y, up)))]);
    return { head: [`y below, x across (${x.unit})`, ...labels(x)], rows };
  }
  const lines = linesOf(options);
  const least = y.log ? 0 : 1e-4 * (y.high - y.low); // what lies between the nodes of a state is no truer
  const number = (value) => (Number.isFinite(value) ? inWords(Math.abs(value) < least ? 0 : value) : "–");
  const rows = labels(x).map((at) => [inWords(at), ...lines.map(({ data }) => number(valueAt(data, at, x, y)))]);
  return { head: [x.name, ...lines.map(({ name }) => name)], rows };
}

// The chart in a sentence.
function wordsOf(options) {
  const { x, y, scale, series } = options;
  const there = (value) => `${inWords(value)} ${x.unit}`.trim();
  const found = [`${y.name} over ${x.name}`];
  if (scale) found.push(`film from ${scale.words.join(" to ")}`);
  const [main] = linesOf(options).sort((one, two) => two.width - one.width);
  const points = main?.data.filter(isThere).sort(([, one], [, two]) => one - two) ?? [];
  if (points.length) {
    const [low, high] = [points[0], points.at(-1)].map(([at, value]) => `${inWords(value)} at ${there(at)}`);
    found.push(`${main.name} from ${low} to ${high}`);
  }
  for (const { type, name, data } of series) {
    if (type === "bands") found.push(...data.map(([low, high, , regime]) => `${regime} from ${there(low)} to ${there(high)}`));
    else if (type === "hatch") found.push(...data.map(([low, high]) => `${name} from ${there(low)} to ${there(high)}`));
    else if (isMark({ type, data })) found.push(`${name} at ${there(data[0][0])}`);
    else if (type === "points" && data.length > 1) found.push(`${name}: ${data.length} points`);
    else if (type === "points") found.push(`${name} ${inWords(data[0][1])} at ${there(data[0][0])}`);
  }
  return found.join("; ");
}

export default {
  props: { label: String },
  template: `
    <div>
      <div class="legend" role="group" :aria-label="'Lines of: ' + label">
        <button v-for="each in legend" :key="each.name" type="button" :aria-pressed="String(!hidden.includes(each.name))"
          :title="(hidden.includes(each.name) ? 'Show ' : 'Hide ') + each.name" @click="toggle(each.name)">
          <svg viewBox="0 0 22 10" aria-hidden="true">
            <circle v-if="each.symbol === 'circle'" cx="11" cy="5" r="3.5" fill="none" :stroke="each.edge" stroke-width="1.6"/>
            <polygon v-else-if="each.symbol" :points="corners(each.symbol)" fill="none" :stroke="each.edge" stroke-width="1.6"/>
            <path v-else d="M 0 5 H 22" :stroke="each.color" :stroke-width="each.width" :stroke-dasharray="each.dash.join(' ')"/>
          </svg>{{ each.name }}</button>
        <button type="button" class="as-table" :aria-pressed="String(asTable)" :aria-label="'As a table: ' + label"
          title="Picture or table" @click="asTable = !asTable; list()">table</button>
      </div>
      <div v-if="asTable" class="scrolled" role="region" :aria-label="label" tabindex="0">
        <table>
          <caption>{{ words }}</caption>
          <tr><th v-for="each in table.head" scope="col">{{ each }}</th></tr>
          <tr v-for="row in table.rows"><th scope="row">{{ row[0] }}</th><td v-for="each in row.slice(1)">{{ each }}</td></tr>
        </table>
      </div>
      <canvas ref="canvas" role="img" :aria-label="label + ': ' + words + '; arrow keys read its values'" tabindex="0"
        v-show="!asTable" @pointermove="move" @pointerdown="move" @pointerleave="leave" @keydown="walk" @blur="leave"></canvas>
      <div class="tip" ref="tip" role="status" hidden></div>
    </div>`,
  data() {
    return { legend: [], hidden: [], asTable: false, words: "", table: { head: [], rows: [] } };
  },
  created() {
    this.options = { series: [], legend: [] };
    this.size = [0, 0];
  },
  mounted() {
    this.brush = this.$refs.canvas.getContext("2d");
    // Kept, as asking for it in every frame would lay out the page in the middle of it.
    this.observer = new ResizeObserver(([{ contentRect }]) => {
      this.size = [contentRect.width, contentRect.height];
      this.paint();
    });
    this.observer.observe(this.$refs.canvas);
    document.fonts.ready.then(() => this.paint());
    this.followScreen();
  },
  beforeUnmount() {
    this.observer.disconnect();
    clearTimeout(this.resting);
    this.unfollow();
  },
  methods: {
    // Another screen has other pixels, which no change of size tells.
    followScreen() {
      const screen = matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`);
      const changed = () => {
        this.paint();
        this.followScreen();
      };
      screen.addEventListener("change", changed, { once: true });
      this.unfollow = () => screen.removeEventListener("change", changed);
    },
    corners(symbol) {
      return CORNERS[symbol].map(([i, j]) => `${11 + 4 * i},${5 + 4 * j}`).join(" ");
    },
    show(chart) {
      this.options = chart;
      const legend = chart.legend.map((name) => chart.series.find((each) => each.name === name));
      const look = ({ name, color, width, dash, edge, symbol }) => ({ name, color, width, dash, edge, symbol });
      if (JSON.stringify(legend.map(look)) !== JSON.stringify(this.legend)) this.legend = legend.map(look);
      this.paint();
      // A screen reader is told at rest.
      clearTimeout(this.resting);
      this.resting = setTimeout(this.list, 400);
      if (this.asTable) this.list();
    },
    list() {
      if (!this.options.x) return;
      const shown = { ...this.options, series: this.shown() };
      this.words = wordsOf(shown);
      if (this.asTable) this.table = tableOf(shown);
    },
    toggle(name) {
      this.hidden = this.hidden.includes(name) ? this.hidden.filter((each) => each !== name) : [...this.hidden, name];
      this.paint();
      this.list();
    },
    shown() {
      return this.options.series.filter((each) => !this.hidden.includes(each.name));
    },
    paint() {
      const { brush, size: [width, height] } = this, { canvas } = brush, ratio = window.devicePixelRatio;
      if (!this.options.x || !width || !height) return;
      if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
      if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
      brush.setTransform(ratio, 0, 0, ratio, 0, 0);
      brush.clearRect(0, 0, width, height);
      const { left, right, top, bottom } = { ...MARGIN, ...this.options.margin };
      const box = { left, top, width: width - left - right, height: height - top - bottom };
      if (this.options.square) box.width = box.height = Math.min(box.width, box.height);
      const on = {
        brush, box, x: scaleOf(this.options.x, box.left, box.left + box.width), y: scaleOf(this.options.y, box.top + box.height, box.top),
      };
      this.on = on;
      const part = (series, what = series.type) => {
        brush.save();
        brush.beginPath();
        // The mark of the present point may stand half outside.
        const room = series.type === "points" ? 0.5 * series.size + 1 : 0;
        brush.rect(box.left - room, box.top - room, box.width + 2 * room, box.height + 2 * room);
        brush.clip();
        PAINT[what]({ ...series, grey: this.options.grey }, on);
        brush.restore();
      };
      const shown = this.shown();
      for (const each of shown) if (BEHIND.includes(each.type)) part(each);
      this.paintAxes(on);
      for (const each of shown) {
        if (each.type === "bands") part(each, "names");
        else if (!BEHIND.includes(each.type)) part(each);
      }
      if (this.options.scale) this.paintScale(on, height);
      if (this.pointer) this.tell();
    },
    paintAxes({ brush, box, x, y }) {
      const { x: across, y: up, grey, grid, square } = this.options;
      const [right, foot] = [box.left + box.width, box.top + box.height];
      const stroke = (colour, lines) => {
        [brush.strokeStyle, brush.lineWidth] = [colour, 1];
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
      if (!square) stroke(grid, [...vertical.map((at) => [at, box.top, at, foot]), ...horizontal.map((at) => [box.left, at, right, at])]);
      stroke(grey, [
        [box.left, pixel(foot), right, pixel(foot)], [pixel(box.left), box.top, pixel(box.left), foot],
        ...vertical.map((at) => [at, foot, at, foot + 5]), ...along.minor.map((value) => [pixel(x(value)), foot, pixel(x(value)), foot + 3]),
        ...horizontal.map((at) => [box.left - 5, at, box.left, at]), ...down.minor.map((value) => [box.left - 3, pixel(y(value)), box.left, pixel(y(value))]),
      ]);
      [brush.fillStyle, brush.font, brush.textBaseline, brush.textAlign] = [grey, `11px ${FONT}`, "middle", "center"];
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
      brush.translate(square ? 12 : 11, box.top + 0.5 * box.height);
      brush.rotate(-0.5 * Math.PI);
      brush.fillText(up.name, 0, 0);
      brush.restore();
    },
    // The colours of a film, from thin to thick, with its ends in words.
    paintScale({ brush, box }, height) {
      const { words, colours } = this.options.scale;
      const [left, width, top] = [box.left + 60, box.width - 130, height - 16];
      const run = brush.createLinearGradient(left, 0, left + width, 0);
      colours.forEach((colour, i) => run.addColorStop(i / (colours.length - 1), colour));
      brush.fillStyle = run;
      brush.fillRect(left, top, width, 11);
      [brush.fillStyle, brush.font, brush.textAlign] = [this.options.grey, `11px ${FONT}`, "right"];
      brush.fillText(words[0], left - 6, top + 6);
      brush.textAlign = "left";
      brush.fillText(words[1], left + width + 6, top + 6);
    },
    move(event) {
      this.pointer = [event.offsetX, event.offsetY];
      this.paint();
    },
    // A readout by keyboard: arrow keys move it, with Shift faster, Escape removes it.
    walk(event) {
      const step = (event.shiftKey ? 40 : 8) * { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.key === "Escape") this.leave();
      if (!step || !this.on) return;
      event.preventDefault();
      const { left, width, top, height } = this.on.box, [across, up] = this.pointer ?? [left + 0.5 * width, top + 0.5 * height];
      this.pointer = [Math.min(Math.max(across + step, left), left + width), up];
      this.paint();
    },
    leave() {
      this.pointer = null;
      this.$refs.tip.hidden = true;
      this.paint();
    },
    // What is under the pointer, in words.
    tell() {
      const { brush, box, x, y } = this.on, { tip } = this.$refs, [across, up] = this.pointer;
      const inside = across >= box.left && across <= box.left + box.width && up >= box.top && up <= box.top + box.height;
      const lines = inside ? this.under(box, x, across, up) : [];
      tip.hidden = lines.length === 0;
      if (tip.hidden) return;
      if (!this.options.square) {
        [brush.strokeStyle, brush.lineWidth] = [this.options.grey, 1];
        brush.setLineDash([2, 3]);
        brush.beginPath();
        brush.moveTo(across, box.top);
        brush.lineTo(across, box.top + box.height);
        brush.stroke();
        brush.setLineDash([]);
      }
      tip.replaceChildren(...lines.map(([words, colour]) => {
        const line = document.createElement("div");
        if (colour) line.style.setProperty("--curve", colour);
        line.textContent = words;
        return line;
      }));
      const { canvas } = this.$refs;
      const beside = across + 14 + tip.offsetWidth > canvas.clientWidth ? across - 14 - tip.offsetWidth : across + 14;
      tip.style.left = `${canvas.offsetLeft + Math.max(0, beside)}px`;
      tip.style.top = `${canvas.offsetTop + Math.max(0, Math.min(up, canvas.clientHeight - tip.offsetHeight))}px`;
    },
    under(box, x, across, up) {
      const film = this.options.series.find((each) => each.type === "film");
      if (film) {
        return [[`film ${filmAt(film, (across - box.left) / box.width, (up - box.top) / box.height)}`]];
      }
      const found = [];
      for (const { type, name, data, color, edge } of this.shown()) {
        if ((type !== "line" && type !== "points") || data.length === 0) continue;
        const away = ([one]) => Math.abs(x(one) - across);
        const near = data.reduce((best, each) => (away(each) < away(best) ? each : best));
        if (near[1] !== null && away(near) < CLOSE) found.push([`${name} ${short(near[1], 4)}`, color ?? edge]);
      }
      const { low, high, log, unit } = this.options.x, part = (across - box.left) / box.width;
      const at = log ? low * (high / low) ** part : low + part * (high - low);
      return found.length ? [[`${short(at, 3)} ${unit}`], ...found] : [];
    },
  },
};
