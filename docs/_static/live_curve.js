// The live curve of the front page: the atlas of solved states, evaluated in the browser and drawn by the explorer's chart.js.
//
// The table, and the rows of the inputs, are in atlas_table.js, which docs/live_curve.py writes from the package. The
// coordinates and sums are those of stribeck/atlas/grid.py and table.py; tests/test_live_curve.py compares the numbers.
// No module and no fetch, so that the page also works from a folder, without a server.
"use strict";

const stribeckAtlas = (() => {
  const data = window.stribeckTable;

  async function inflated(text) {
    const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // Whole numbers come as four planes of bytes, which deflate better.
  const whole = planes => {
    const n = planes.length / 4;
    return Int32Array.from({length: n}, (_, i) =>
      planes[i] | (planes[n + i] << 8) | (planes[2 * n + i] << 16) | (planes[3 * n + i] << 24));
  };

  function chebyshev(x, terms) {
    const values = [1, x];
    for (let n = 2; n < terms; n++) values.push(2 * x * values[n - 1] - values[n - 2]);
    return values;
  }

  const clip = (x, low, high) => Math.min(Math.max(x, low), high);

  function local(coordinate, pieces) {
    const along = 0.5 * pieces * (coordinate + 1);
    const piece = clip(Math.trunc(along), 0, pieces - 1);
    return [piece, clip(2 * (along - piece) - 1, -1, 1)];
  }

  async function load() {
    const coefficients = whole(await inflated(data.coefficients));
    const breaks = new Float64Array((await inflated(data.breaks)).buffer);
    const film = new Float64Array((await inflated(data.film)).buffer);
    const {regions, functions, step, breakTerms, filmShape, filmRange, box, heavy} = data;
    const [ODDS, VISCOUS, CENTRAL, MINIMUM] = [0, 1, 2, 3];
    const count = functions.length;

    // Where each piece of each region begins among the coefficients.
    let position = 0;
    for (const region of regions) {
      region.begins = [];
      for (let piece = 0; piece < region.pieces[0] * region.pieces[1]; piece++) {
        region.begins.push(region.speeds.map(terms => {
          const begin = position;
          position += count * terms * region.nodes[0] * region.nodes[1];
          return begin;
        }));
      }
    }

    function filmAt(s) {
      const [low, high] = filmRange, [pieces, terms] = filmShape;
      const [piece, x] = local((2 * Math.max(s, low) - low - high) / (high - low), pieces);
      const T = chebyshev(x, terms);
      return functions.map((_, f) => f === ODDS ? Infinity
        : T.reduce((sum, value, t) => sum + value * film[(piece * terms + t) * (count - 1) + f - 1], 0));
    }

    // All functions of ln(speed) at a load and a relative roughness: sums over both are taken once for a whole curve.
    function along(load, kappa) {
      if (kappa === 0) return filmAt;
      const L = clip(-Math.log(load), 0, -Math.log(box.load[0]));
      kappa = clip(kappa, ...box.kappa);
      const rough = regions.slice(2).filter(region => kappa >= region.roughness[0]).length;
      const number = rough > 0 ? rough + 1 : L < heavy ? 1 : 0, region = regions[number];
      const delta = region.closing || 2 * kappa / (1 + kappa);
      const ends2 = region.roughness.map(Math.log), logs = region.logs.map(end => Math.log(end + delta));
      const k = (2 * Math.log(kappa) - ends2[0] - ends2[1]) / (ends2[1] - ends2[0]);
      const y = (2 * Math.log(L + delta) - logs[0] - logs[1]) / (logs[1] - logs[0]);
      const [Tk, Ty] = [chebyshev(k, breakTerms), chebyshev(y, breakTerms)];
      const b = [0, 1, 2, 3, 4].map(n => {
        let sum = 0;
        for (let i = 0; i < breakTerms; i++)
          for (let j = 0; j < breakTerms; j++)
            sum += breaks[((number * 5 + n) * breakTerms + i) * breakTerms + j] * Tk[i] * Ty[j];
        return sum;
      });
      const ends = [b[0], 0.5 * (b[0] + b[1]), ...b.slice(1)];
      const [[i, kLocal], [j, yLocal]] = [local(k, region.pieces[0]), local(y, region.pieces[1])];
      const begins = region.begins[i * region.pieces[1] + j], [nk, ny] = region.nodes;
      const [K, Y] = [chebyshev(kLocal, nk), chebyshev(yLocal, ny)];
      const series = new Map();

      function seriesOf(segment) {
        if (!series.has(segment)) {
          const terms = region.speeds[segment];
          let at = begins[segment];
          series.set(segment, functions.map(() => Array.from({length: terms}, () => {
            let sum = 0;
            for (let a = 0; a < nk; a++)
              for (let c = 0; c < ny; c++) sum += coefficients[at++] * K[a] * Y[c];
            return step * sum;
          })));
        }
        return series.get(segment);
      }

      return s => {
        const segment = Math.max(ends.filter(end => s >= end).length, region.speeds[0] > 0 ? 0 : 1);
        if (segment >= region.speeds.length) return filmAt(s);
        const low = ends[Math.max(segment - 1, 0)], high = ends[segment];
        const t = segment === 0 ? 2 * Math.exp(2 * Math.min(s - ends[0], 0)) - 1
          : clip(2 * (s - low) / ((high - low) || 1) - 1, -1, 1);
        const T = chebyshev(t, region.speeds[segment]);
        const found = seriesOf(segment).map(row => row.reduce((sum, value, n) => sum + value * T[n], 0));
        if (segment === 0) found[ODDS] += 2 * s;
        return found;
      };
    }

    const slack = 1e-12;
    const within = (value, [low, high]) => value >= low * (1 - slack) && value <= high * (1 + slack);

    // A function of the speed group that returns friction, its parts, shares and gaps [u_Hz]; null beyond the table.
    function curve(load, roughness, friction0, beta) {
      const kappa = roughness / load;
      if (!within(load, box.load) || !(kappa === 0 || within(kappa, box.kappa))) return null;
      const read = along(load, kappa);
      return speed => {
        if (!within(speed, box.speed)) return null;
        const found = read(Math.log(speed));
        const share = 1 / (1 + Math.exp(found[ODDS])), solid = friction0 * share;
        const viscous = beta * Math.sqrt(load) * speed * Math.exp(found[VISCOUS]);
        return {
          friction: solid + viscous, solid, viscous, contactShare: share, fluidShare: 1 / (1 + Math.exp(-found[ODDS])),
          centralGap: Math.exp(found[CENTRAL]), minimumGap: Math.exp(found[MINIMUM]),
        };
      };
    }

    return {curve, box};
  }

  return {load, table: data};
})();

// What the sliders give: the groups, and what turns a speed group and a gap into what the page shows.
function stribeckState(mode, v) {
  const {beta, boundary_friction: mu0} = v;
  if (mode === "groups") {
    const {load_group: load, roughness_group: roughness, speed_group: speed} = v;
    return {load, roughness, speed, mu0, beta, perSpeed: 1, gap: 0, rms: roughness / load};
  }
  const {radius: R, modulus: E, load: F, viscosity: eta, speed: U, roughness: h, alpha} = v;
  const perSpeed = 3 * Math.PI ** 2 / 4 * (eta / F) * (R / F * E), gap = 4 * F / E / Math.PI;
  const [load, roughness] = [F / R / E / beta / beta / Math.PI, h / R / beta / beta / alpha / 4];
  return {load, roughness, speed: perSpeed * U, mu0, beta, perSpeed, gap, rms: h / gap};
}

(async () => {
  const place = document.getElementById("live-curve");
  if (!place || typeof DecompressionStream === "undefined") return;  // the picture stays
  const {inputs} = stribeckAtlas.table, atlas = await stribeckAtlas.load();
  const NAME = "live-curve", POINTS = 241;
  const start = Object.fromEntries(Object.values(inputs).flat().map(row => [row.name, row.value]));
  let mode = "si", values = {...start};

  // --- numbers ---

  function number(value, digits = 3) {
    if (value === 0 || (Math.abs(value) >= 1e-3 && Math.abs(value) < 1e4)) return String(Number(value.toPrecision(digits)));
    const [digit, power] = value.toExponential(digits - 1).split("e");
    return `${Number(digit)}e${Number(power)}`;
  }

  function withUnit(value, steps, digits = 3) {
    const powers = Object.keys(steps).map(Number).sort((a, b) => a - b);
    const exponent = value === 0 ? 0 : Number(value.toExponential(digits - 1).split("e")[1]);
    const power = Math.max(powers[0], ...powers.filter(each => each <= exponent));
    return `${number(value / 10 ** power, digits)} ${steps[power].replace("*", "·")}`.trim();
  }

  const regimeOf = at => at.solid <= 0.1 * at.friction ? "hydrodynamic" : at.fluidShare <= 0.05 ? "boundary" : "mixed";

  // Where a function of ln(speed) changes its sign between two speeds.
  function root(f, low, high) {
    const rising = f(low) < 0;
    for (let i = 0; i < 60; i++) {
      const middle = Math.sqrt(low * high);
      if ((f(middle) < 0) === rising) low = middle; else high = middle;
    }
    return Math.sqrt(low * high);
  }

  function minimumOf(f, low, high) {
    const golden = (Math.sqrt(5) - 1) / 2;
    let [a, b] = [Math.log(low), Math.log(high)];
    for (let i = 0; i < 60; i++) {
      const [c, d] = [b - golden * (b - a), a + golden * (b - a)];
      if (f(Math.exp(c)) < f(Math.exp(d))) b = d; else a = c;
    }
    return Math.exp(0.5 * (a + b));
  }

  // All that is shown, from the values of the sliders; null beyond the table.
  function evaluate() {
    const state = stribeckState(mode, values), read = atlas.curve(state.load, state.roughness, state.mu0, state.beta);
    const row = inputs[mode].find(each => each.name.startsWith("speed"));
    if (!read) return {state, row};
    const speeds = Array.from({length: POINTS}, (_, i) => row.low * (row.high / row.low) ** (i / (POINTS - 1)));
    const at = speed => read(speed * state.perSpeed);
    const points = speeds.map(speed => [speed, at(speed)]).filter(([, found]) => found);
    let minimum = null;
    const lowest = points.reduce((best, [, found], i) => found.friction < points[best][1].friction ? i : best, 0);
    if (lowest > 0 && lowest < points.length - 1)
      minimum = minimumOf(speed => at(speed).friction, points[lowest - 1][0], points[lowest + 1][0]);
    const bands = [];
    for (const [speed, found] of points) {
      const regime = regimeOf(found), last = bands.at(-1);
      if (last && last.regime === regime) last.high = speed;
      else {
        const line = regime === "hydrodynamic" ? x => at(x).solid / at(x).friction - 0.1 : x => at(x).fluidShare - 0.05;
        const low = last ? root(line, last.high, speed) : speed;
        if (last) last.high = low;
        bands.push({regime, low, high: speed});
      }
    }
    return {state, row, points, minimum, bands, at, now: at(values[row.name])};
  }

  // --- the page ---

  function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  const picture = element("div"), chart = new StribeckChart(picture, "Friction over speed");
  const said = element("p", {class: "live-said", role: "status"});
  const modes = element("fieldset", {class: "live-modes"}, element("legend", {}, "Inputs"));
  const sliders = element("div", {class: "live-sliders"});
  const link = element("button", {type: "button"}, "Copy link"), reset = element("button", {type: "button"}, "Reset");
  for (const [value, words] of [["si", "SI units"], ["groups", "dimensionless groups"]]) {
    const radio = element("input", {type: "radio", name: `${NAME}-mode`, value, id: `${NAME}-${value}`});
    radio.addEventListener("change", () => {
      mode = value;
      if (mode === "groups") groupsOfContact();
      build();
      show();
    });
    modes.append(element("span", {}, radio, element("label", {for: radio.id}, words)));
  }

  // The sliders of the groups begin with the contact that was shown, as far as they reach.
  function groupsOfContact() {
    const {speed, load, roughness} = stribeckState("si", values);
    for (const [name, value] of Object.entries({speed_group: speed, load_group: load, roughness_group: roughness})) {
      const row = inputs.groups.find(each => each.name === name);
      values[name] = Math.min(Math.max(value, row.low), row.high);
    }
  }

  function build() {
    document.getElementById(`${NAME}-${mode}`).checked = true;
    sliders.replaceChildren(...inputs[mode].map(row => {
      const id = `${NAME}-${row.name}`, ends = [row.low, row.high].map(Math.log10);
      const range = element("input", {type: "range", id, name: row.name, min: ends[0], max: ends[1], step: 0.01});
      range.value = Math.log10(values[row.name]);
      range.addEventListener("input", () => {
        values[row.name] = 10 ** Number(range.value);
        show();
      });
      return element("div", {class: "live-row"}, element("label", {for: id}, row.label), range, element("span", {"aria-hidden": "true"}));
    }));
  }

  function draw({row, points, minimum, bands, now}) {
    const heights = points.flatMap(([, found]) => [found.friction]);
    const low = 10 ** Math.floor(Math.log10(Math.min(...heights)) - 0.3), high = 10 ** Math.ceil(Math.log10(Math.max(...heights) * 1.1));
    const unit = mode === "si" ? "m/s" : "", ends = {low: row.low, high: row.high, log: true};
    const line = (id, name, look, of) => ({id, name, look, type: "line", data: points.map(([x, found]) => [x, of(found)])});
    const series = [
      line("friction", "friction", "main", found => found.friction),
      line("contact", "from asperities", "contact", found => found.solid),
      line("fluid", "from the fluid", "fluid", found => found.viscous),
      {id: "bands", name: "regimes", type: "bands", data: bands.map(band => [band.low, band.high, band.regime])},
    ];
    if (minimum) series.push({id: "minimum", name: "minimum friction", type: "line", data: [[minimum, low], [minimum, high]]});
    series.push({id: "point", name: "this contact", type: "points", data: [[values[row.name], now.friction]]});
    const x = {name: mode === "si" ? "speed (m/s)" : "speed group (–)", unit, ...ends};
    chart.show({x, y: {name: "friction coefficient µ (–)", unit: "", low, high, log: true}, series});
  }

  function sentence({state, row, now, minimum, at}) {
    const speed = value => mode === "si" ? withUnit(value, row.steps) : `speed group ${number(value)}`;
    const film = now.minimumGap * state.gap;
    const parts = [`${regimeOf(now)} lubrication at ${speed(values[row.name])}: friction ${number(now.friction, 4)} `
      + `(${number(100 * now.solid / now.friction)}\u00a0% from asperities); the fluid carries ${number(100 * now.fluidShare)}\u00a0% of the load.`];
    const lambda = state.rms > 0 ? `, ${number(now.minimumGap / state.rms)} times the roughness` : "";
    const lengths = inputs.si[0].steps;
    parts.push(mode === "si" ? `Minimum film ${withUnit(film, lengths)}${lambda}.` : `Minimum gap ${number(now.minimumGap)} of the Hertz indentation.`);
    if (minimum) parts.push(`Friction is at its minimum, ${number(at(minimum).friction, 4)}, at ${speed(minimum)}.`);
    const text = parts.join(" ");
    return text[0].toUpperCase() + text.slice(1);
  }

  function beyond(state) {
    const {load, kappa} = atlas.box;
    return `The table of this page covers load groups of ${number(load[0])} to ${load[1]} and relative roughnesses of ${number(kappa[0])} to ${kappa[1]}; `
      + `this contact has ${number(state.load)} and ${number(state.roughness / state.load)}. The package solves it: stribeck curve.`;
  }

  function show() {
    const found = evaluate(), shown = Boolean(found.points?.length && found.now);
    for (const row of inputs[mode]) {
      const range = sliders.querySelector(`[name=${row.name}]`), text = withUnit(values[row.name], row.steps);
      range.setAttribute("aria-valuetext", text);
      range.nextSibling.textContent = text;
    }
    place.classList.toggle("live-beyond", !shown);
    if (shown) draw(found);
    said.textContent = shown ? sentence(found) : beyond(found.state);
    place.dataset.friction = shown ? found.now.friction : "";
    place.dataset.minimum = shown && found.minimum ? found.minimum : "";
    const query = new URLSearchParams({mode});
    for (const row of inputs[mode]) query.set(row.name, String(values[row.name]));
    history.replaceState(null, "", `#${NAME}?${query}`);
  }

  function read() {
    if (!location.hash.startsWith(`#${NAME}?`)) return;
    const query = new URLSearchParams(location.hash.slice(NAME.length + 2));
    mode = query.get("mode") === "groups" ? "groups" : "si";
    for (const row of inputs[mode]) {
      const value = Number(query.get(row.name));
      if (Number.isFinite(value) && value > 0) values[row.name] = value;
    }
  }

  link.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(location.href);
      link.textContent = "Link copied";
    } catch {  // a page from a folder may not
      link.textContent = "Copy the address of this page";
    }
    setTimeout(() => { link.textContent = "Copy link"; }, 2000);
  });
  reset.addEventListener("click", () => { values = {...start}; build(); show(); });
  window.addEventListener("hashchange", () => { read(); build(); show(); });

  place.replaceChildren(element("div", {class: "live-left"}, picture, said),
    element("div", {class: "live-right"}, modes, sliders, element("div", {class: "live-buttons"}, link, reset)));
  read();
  build();
  const hash = location.hash;
  show();
  if (!hash.startsWith(`#${NAME}`)) history.replaceState(null, "", hash || location.pathname + location.search);
  place.dataset.ready = "yes";
})();
