// The page: what Python sends is shown, and what the user does is sent to Python as ["what", ...].
// Native elements, so that keyboard, phone and screen reader know them.

// What a name means, behind a question mark, with a link to all words.
const Ask = {
  props: { name: String, label: String, words: String },
  template: `<button type="button" class="ask" :aria-label="'What is: ' + label" :aria-expanded="String(open)" @click="open = !open">?</button>
    <p class="help" v-if="open">{{ words }} <a :href="'/words#' + name" target="_blank">All words</a></p>`,
  data: () => ({ open: false }),
};

// What is folded away until it is wanted, or something in it is wrong.
const Fold = {
  props: { name: String, title: String, wrong: Boolean },
  template: `<details class="fold" ref="fold" :data-fold="name"><summary>{{ title }}</summary><slot/></details>`,
  watch: { wrong: "follow" },
  mounted() {
    this.follow();
  },
  methods: {
    follow() {
      if (this.wrong) this.$refs.fold.open = true;
    },
  },
};

// A quantity: its name, a field, its unit and a slider.
const Knob = {
  components: { Ask },
  props: { now: Object, busy: Function },
  emits: ["act"],
  template: `
    <div class="knob" :class="{wrong: sentence}" :data-row="now.name">
      <label class="name" :for="'field-' + now.name">{{ now.label }}<i v-html="now.symbol"></i></label>
      <ask :name="now.name" :label="now.label" :words="now.help"></ask>
      <input class="field" type="text" :id="'field-' + now.name" :name="now.name" v-model="text" autocomplete="off" spellcheck="false"
        :aria-invalid="String(Boolean(sentence))" :aria-describedby="'sentence-' + now.name"
        @keydown.enter="commit" @keydown.esc="restore" @blur="commit" @keydown.ctrl="text === now.text || $event.stopPropagation()">
      <select v-if="now.units.length" class="unit" :aria-label="'Unit of ' + now.label" :value="now.unit"
        @change="$emit('act', ['unit', now.name, $event.target.value])">
        <option v-for="each in now.units" :key="each" :value="each">{{ each.replace('*', '·') }}</option>
      </select>
      <input class="slider" type="range" :min="now.ends[0]" :max="now.ends[1]" step="0.01" v-model.number="place" :aria-label="now.label"
        :aria-valuetext="text + ' ' + now.unit" @input="$emit('act', ['slide', now.name, place])"
        @pointerdown="held = true" @pointerup="held = false" @pointercancel="held = false">
      <div class="sentence" role="alert" :id="'sentence-' + now.name">{{ sentence }}</div>
      <div class="caption" v-if="now.note">{{ now.note }}</div>
    </div>`,
  data() {
    return { text: "", sentence: "", place: 0, held: false };
  },
  created() {
    this.take();
  },
  // A slider that is being moved stays in the hand that moves it.
  watch: { now: "take" },
  methods: {
    take() {
      [this.text, this.sentence] = [this.now.typed ?? this.now.text, this.now.sentence ?? ""];
      if (!this.held && !this.busy()) this.place = this.now.place;
    },
    commit() {
      if (this.text !== this.now.text || this.sentence) this.$emit("act", ["type", this.now.name, this.text]);
    },
    restore() {
      if (this.sentence) this.$emit("act", ["restore", this.now.name]);
      [this.text, this.sentence] = [this.now.text, ""];
    },
  },
};

// A list to choose from, and fields for what the choice needs.
const List = {
  components: { Ask },
  props: { now: Object },
  emits: ["act"],
  template: `
    <div class="choice-row" v-show="!now.hidden" :data-choice="now.name">
      <label class="name" :for="'choice-' + now.name">{{ now.label }}</label><ask :name="now.name" :label="now.label" :words="now.help"></ask>
      <select class="list" ref="list" :id="'choice-' + now.name" :value="now.value" @change="$emit('act', ['pick', now.name, $event.target.value])">
        <option v-for="each in now.options" :key="each[0]" :value="each[0]">{{ each[1] }}</option>
      </select>
      <template v-for="[key, label, , empty] in now.details" :key="key">
        <label class="detail" :for="'detail-' + now.name + '-' + key">{{ label }}</label>
        <input class="field" type="text" :id="'detail-' + now.name + '-' + key" :name="key" v-model="texts[key]"
          :placeholder="empty" autocomplete="off" spellcheck="false" :aria-invalid="String(Boolean(sentence) && now.wrong === key)"
          :aria-describedby="'choice-sentence-' + now.name" @keydown.enter="commit(key)" @keydown.esc="restore" @blur="commit(key)"
          @keydown.ctrl="texts[key] === given[key] || $event.stopPropagation()">
      </template>
      <div class="sentence" role="alert" :id="'choice-sentence-' + now.name">{{ sentence }}</div>
    </div>`,
  data() {
    return { texts: {}, given: {}, sentence: "" };
  },
  created() {
    this.take();
  },
  watch: { now: "take" },
  methods: {
    take() {
      this.given = Object.fromEntries(this.now.details.map(([key, , text]) => [key, text]));
      this.texts = { ...this.given, ...(this.now.wrong ? { [this.now.wrong]: this.now.typed } : {}) };
      this.sentence = this.now.sentence ?? "";
      if (this.$refs.list) this.$refs.list.value = this.now.value; // a choice that was refused goes back
    },
    commit(key) {
      if (this.texts[key] !== this.given[key] || (this.sentence && this.now.wrong === key)) {
        this.$emit("act", ["detail", this.now.name, key, this.texts[key]]);
      }
    },
    restore() {
      if (this.sentence) this.$emit("act", ["restore", this.now.name]);
      [this.texts, this.sentence] = [{ ...this.given }, ""];
    },
  },
};

const CHARTS = {
  friction: "Friction over speed",
  residuals: "Residuals of the fit",
  gap: "Gap along the contact",
  pressure: "Contact and fluid pressure along the contact",
  shape: "Undeformed shape of the body",
  plane: "Film of the ball on the plane of the contact",
  diagram: "Regimes over speed and roughness",
};

const say = (message, timeout = 6000) => Quasar.Notify.create({ message, timeout, closeBtn: "Close" });

export default {
  components: { Ask, Fold, Knob, List },
  props: { client: String, kinds: Object, examples: Array, endings: String, toggles: Object },
  emits: ["act"],
  template: `
    <div class="explorer" :class="{working}" :data-geometry="geometry">
      <header class="bar">
        <h1><b>stribeck</b> explorer<span>{{ title }}</span></h1>
        <input class="hidden-upload" ref="upload" type="file" multiple :accept="endings" aria-hidden="true" tabindex="-1" @change="upload">
        <q-btn flat dense no-caps icon="upload_file" label="Load" title="Load a case, a measured curve, a surface or an example"><q-menu><q-list>
          <q-item clickable v-close-popup @click="$refs.upload.click()"><q-item-section>File: a case (TOML), a measured curve (CSV) or a height map ...</q-item-section></q-item>
          <q-item-label header>Examples</q-item-label>
          <q-item v-for="each in examples" :key="each" clickable v-close-popup @click="act('example', each)"><q-item-section>{{ each }}</q-item-section></q-item>
        </q-list></q-menu></q-btn>
        <q-btn flat dense no-caps icon="download" label="Save" title="Download picture, data or case"><q-menu><q-list>
          <q-item v-for="(kind, label) in kinds" :key="kind" clickable v-close-popup @click="download(kind)"><q-item-section>{{ label }}</q-item-section></q-item>
        </q-list></q-menu></q-btn>
        <q-btn flat dense no-caps icon="undo" aria-label="Undo" title="Undo (Ctrl-Z)" :disable="!undo" @click="act('undo')"/>
        <q-btn flat dense no-caps icon="redo" aria-label="Redo" title="Redo (Ctrl-Y)" :disable="!redo" @click="act('redo')"/>
        <q-btn flat dense no-caps icon="push_pin" label="Pin" title="Keep this curve to compare (p)" @click="act('pin')"/>
        <q-btn flat dense no-caps icon="content_copy" label="Copy" title="Copy the address of this state (l), or a program that makes it"><q-menu><q-list>
          <q-item clickable v-close-popup @click="copy"><q-item-section>Link to this state</q-item-section></q-item>
          <q-item clickable v-close-popup @click="act('code', 'python')"><q-item-section>As Python ...</q-item-section></q-item>
          <q-item clickable v-close-popup @click="act('code', 'command')"><q-item-section>As a command ...</q-item-section></q-item>
        </q-list></q-menu></q-btn>
        <q-btn flat dense no-caps icon="contrast" aria-label="Toggle dark mode" title="Toggle dark mode (t)" @click="toggleDark"/>
      </header>
      <section class="card answer" aria-label="Answer">
        <div class="status" :class="{said: !failed}" role="status">{{ message }}</div>
        <div class="retry" v-if="failed">
          <q-btn flat dense no-caps icon="refresh" label="Try again" title="Compute this once more" @click="act('retry')"/>
          <q-btn flat dense no-caps icon="undo" label="Back" title="Go back to what is shown" @click="act('back')"/>
        </div>
        <template v-if="answer">
          <div class="regime" :class="answer.regime" data-key="regime" :data-value="answer.regime" data-error="0">{{ answer.regime }}<small>{{ answer.meaning }}</small></div>
          <dl><div v-for="[label, text, interval] in answer.main" :key="label"><dt>{{ label }}</dt><dd>{{ text }}<small v-if="interval">95 %: {{ interval }}</small></dd></div></dl>
          <div class="verdict" :class="answer.verdict" data-key="verdict" :data-value="answer.verdict" role="status">
            <details v-if="answer.reasons.length" :open="answer.verdict === 'outside'"><summary>{{ answer.headline }}</summary><p v-for="each in answer.reasons">{{ each }}</p></details>
            <template v-else>{{ answer.headline }}</template>
          </div>
          <div class="ways"><h2>What to change <span class="waits">{{ waits }}</span></h2><table>
            <tr v-for="([[name], ...cells], i) in answer.ways" :key="name" :data-key="name || null"><component :is="i ? 'th' : 'td'" :scope="i ? 'row' : null">{{ name }}</component>
              <component :is="i ? 'td' : 'th'" v-for="([text, small, value, look], k) in cells" :key="k" :scope="i ? null : 'col'" :class="look" :data-value="value || null">{{ text }} <small>{{ small }}</small></component></tr>
          </table></div>
        </template>
      </section>
      <section class="card controls" aria-label="Inputs">
        <h2>Contact</h2>
        <p class="caption">Type numbers as data sheets have them: 70 Shore A, Ra 0.4 um, 46 cSt, 1500 rpm, 30 mm. A ? says what there is.</p>
        <list v-for="each in lists.slice(0, 1)" :key="each.name" :now="each" @act="forward"></list>
        <knob v-for="each in rows.slice(0, 6)" :key="each.name" :now="each" :busy="isBusy" @act="forward"></knob>
        <fold name="more" title="More inputs" :wrong="isWrong(rows.slice(6))">
          <knob v-for="each in rows.slice(6)" :key="each.name" :now="each" :busy="isBusy" @act="forward"></knob>
        </fold>
        <fold name="model" title="Model and definition of friction" :wrong="isWrong(lists.slice(1))">
          <list v-for="each in lists.slice(1)" :key="each.name" :now="each" @act="forward"></list>
          <div class="choice-row"><span class="name">Fluid friction</span><div class="choice"><q-btn-toggle no-caps unelevated dense aria-label="definition"
            :options="optionsOf('definition')" :model-value="chosen.definition" @update:model-value="value => act('choose', 'definition', value)"/></div></div>
        </fold>
        <fold name="groups" title="Dimensionless groups" :wrong="isWrong(groups)" v-if="groups.length">
          <knob v-for="each in groups" :key="each.name" :now="each" :busy="isBusy" @act="forward"></knob>
          <p class="caption">Changing one group changes speed, load and roughness; the other two groups stay fixed.</p>
        </fold>
      </section>
      <div class="middle">
        <section class="card friction" aria-label="Stribeck curve">
          <div class="head">
            <h2>Stribeck curve</h2><div class="caption source">{{ source }}</div>
            <div class="choice"><q-btn-toggle no-caps unelevated dense aria-label="abscissa"
              :options="optionsOf('abscissa')" :model-value="chosen.abscissa" @update:model-value="value => act('choose', 'abscissa', value)"/></div>
          </div>
          <div class="below">
            <div class="chips"><q-chip v-for="(each, i) in chips" :key="each.name" removable :icon="each.icon" :style="'--curve: var(--' + each.colour + ')'"
              @remove="act('remove', i)">{{ each.name }}</q-chip></div>
            <q-btn v-if="fit" flat dense no-caps icon="insights" label="Fit" title="Fit inputs to the measured curve" @click="act('show_fit')"/>
          </div>
          <form class="mapping" v-if="mapping" aria-label="Columns of the file" @submit.prevent="act('read_columns', columns, units)">
            <p>{{ mapping.said ? mapping.said + '. Say below which is which.' : 'Say what the columns of ' + mapping.file + ' are.' }}</p>
            <div class="choice-row" v-for="each in mapping.meanings" :key="each"><label class="name" :for="'column-' + each">{{ each.replaceAll('_', ' ') }}</label>
              <select class="list" :id="'column-' + each" v-model="columns[each]"><option value="">as the header says</option>
                <option v-for="name in mapping.headers" :key="name">{{ name }}</option></select>
              <template v-if="columns[each] && each !== 'curve'"><label class="detail" :for="'unit-' + each">its unit, where the header has none</label>
                <input class="field" type="text" :id="'unit-' + each" v-model="units[each]" autocomplete="off"></template></div>
            <q-btn flat dense no-caps type="submit" icon="check" label="Read"/><q-btn flat dense no-caps icon="close" label="Cancel" @click="mapping = null"/>
          </form>
          <div class="fitting" v-show="fitting" role="region" aria-label="Fit">
            <template v-if="fitting"><h2>Fit to {{ fitting.file }}</h2><p class="caption">{{ fitting.taken }} <button type="button" @click="act('ask_columns')">Change the columns</button></p>
              <label v-for="[name, label] in fitting.inputs" :key="name"><input type="checkbox" :value="name" v-model="freed"> {{ label }}</label>
              <div><q-btn flat dense no-caps icon="insights" label="Fit these" :disable="!freed.length" @click="act('fit', ...freed)"/>
                <q-btn flat dense no-caps icon="close" label="Close" @click="fitting = null"/></div></template>
            <template v-if="fitted"><table><tr><td></td><th scope="col">value</th><th scope="col">error</th><th scope="col">95 %</th></tr>
              <tr v-for="[label, ...cells] in fitted.rows" :key="label"><th scope="row">{{ label }}</th><td v-for="each in cells">{{ each }}</td></tr></table>
              <p>{{ fitted.said }}</p><p class="note" v-for="each in fitted.notes">{{ each }}</p></template>
            <div class="chart-residuals" v-show="fitted" ref="residuals"></div>
          </div>
          <div class="chart-friction" ref="friction"></div>
          <div class="curve-notes" tabindex="0" role="region" aria-label="Notes on the curve"><p class="note" v-for="each in notes">{{ each }}</p></div>
          <div class="comparison" v-if="comparison.length"><table>
            <tr v-for="([label, ...texts], i) in comparison" :key="i"><component :is="i ? 'th' : 'td'" :scope="i ? 'row' : null">{{ label }}</component>
              <component :is="i ? 'td' : 'th'" v-for="(each, k) in texts" :key="k" :scope="i ? null : 'col'">{{ each }}</component></tr>
          </table></div>
        </section>
        <section class="card fields" aria-label="Gap and pressure">
          <h2>Gap and pressure along the contact</h2>
          <div class="pair"><div class="chart-gap" ref="gap"></div><div class="chart-pressure" ref="pressure"></div></div>
          <div class="of-shape" v-show="shape"><h2>{{ shape }}</h2><div class="chart-shape" ref="shape"></div></div>
          <div class="of-ball" v-show="geometry === 'point'"><h2>Film on the plane of the contact</h2><div class="chart-plane" ref="plane"></div></div>
        </section>
      </div>
      <div class="side">
        <section class="card numbers" aria-label="Numbers">
          <h2>Numbers</h2>
          <table>
            <tr v-if="numbers.some(each => each.interval)"><td></td><td></td><th scope="col">95 %</th></tr>
            <tr v-for="each in numbers" :key="each.key" :data-key="each.key" :data-value="each.value" :data-error="each.error">
              <th scope="row">{{ each.label }}<ask :name="each.key" :label="each.label" :words="each.help + '. ' + each.tip"></ask></th>
              <td :title="each.tip">{{ each.text }}</td><td>{{ each.interval }}</td>
            </tr>
          </table>
          <p class="note" v-for="each in remarks">{{ each }}</p>
        </section>
        <section class="card diagram" aria-label="Phase diagram">
          <h2>Regimes <span class="caption">{{ map }}</span></h2><div class="chart-diagram" ref="diagram"></div>
        </section>
      </div>
      <q-dialog :model-value="complaint.length > 0" @update:model-value="complaint = []"><q-card class="complaint">
        <div v-for="each in complaint">{{ each }}</div><q-btn flat no-caps label="Close" autofocus v-close-popup/>
      </q-card></q-dialog>
      <q-dialog :model-value="Boolean(code)" @update:model-value="code = ''"><q-card class="complaint">
        <pre class="code" tabindex="0">{{ code }}</pre><q-btn flat no-caps icon="content_copy" label="Copy" @click="write(code, 'Copied')"/><q-btn flat no-caps label="Close" autofocus v-close-popup/>
      </q-card></q-dialog>
    </div>`,
  data() {
    const texts = ["title", "source", "message", "waits", "map", "shape", "address", "code"], flags = ["working", "undo", "redo", "fit", "failed"];
    const lists = ["lists", "rows", "groups", "chips", "complaint", "notes", "numbers", "remarks", "comparison"];
    const empty = [...texts.map((each) => [each, ""]), ...lists.map((each) => [each, []]), ...flags.map((each) => [each, false])];
    return { ...Object.fromEntries(empty), geometry: "line", chosen: {}, answer: null, mapping: null, columns: {}, units: {}, fitting: null, fitted: null, freed: [] };
  },
  watch: {
    mapping() {
      [this.columns, this.units] = [Object.fromEntries((this.mapping?.meanings ?? []).map((each) => [each, ""])), {}];
    },
    fitting(now) {
      if (now) [this.fitted, this.freed] = [null, now.inputs.filter(([, , chosen]) => chosen).map(([name]) => name)];
    },
    geometry() {
      this.fitting = this.fitted = null;
    },
    address(query) {
      history.replaceState(null, "", query);
    },
  },
  mounted() {
    document.documentElement.lang = "en";
    this.charts = Object.fromEntries(Object.entries(CHARTS).map(([name, label]) => [name, new StribeckChart(this.$refs[name], label)]));
    for (const chart of Object.values(this.charts)) chart.onDrag = (name, place) => this.forward(["slide", name, place]);
    document.addEventListener("keydown", this.press);
  },
  unmounted() {
    document.removeEventListener("keydown", this.press);
  },
  methods: {
    act(...what) {
      this.$emit("act", what);
    },
    isWrong: (some) => some.some((each) => each.sentence),
    optionsOf(name) {
      return Object.entries(this.toggles[name]).map(([value, label]) => ({ value, label }));
    },
    // One move of a slider is on its way to Python at a time; while it is, only the last place is kept.
    forward(what) {
      if (what[0] !== "slide") this.act(...what);
      else if (this.waiting) this.next = what;
      else {
        this.waiting = setTimeout(this.free, 1000);
        this.act(...what);
      }
    },
    isBusy() {
      return Boolean(this.next);
    },
    free() {
      clearTimeout(this.waiting);
      const next = this.next;
      this.waiting = this.next = null;
      if (next) this.forward(next);
    },
    // Shows what changed; returning tells Python that it is drawn.
    async show({ charts = {}, ...parts }) {
      Object.assign(this, parts);
      for (const [name, options] of Object.entries(charts)) this.charts[name].show(options);
      await this.$nextTick();
      this.free();
      document.dispatchEvent(new CustomEvent("shown", { detail: parts }));
      return true;
    },
    // Ctrl-Z also while a slider or a field that holds no new text has the focus; a field that is edited undoes its own letters.
    press(event) {
      const key = event.key.toLowerCase(), isControl = event.ctrlKey || event.metaKey;
      if (event.altKey || (!isControl && event.target.closest("input, select, textarea"))) return;
      if (isControl) {
        const way = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : "";
        if (!way) return;
        event.preventDefault();
        if (this[way]) this.act(way);
      } else if (key === "p") this.act("pin");
      else if (key === "t") this.toggleDark();
      else if (key === "l") this.copy();
    },
    toggleDark() {
      Quasar.Dark.toggle();
    },
    write(text, done, otherwise = "Could not copy; select the text") {
      const write = navigator.clipboard ? navigator.clipboard.writeText(text) : Promise.reject();
      write.then(() => say(done, 1600), () => say(otherwise, 1600));
    },
    copy() {
      this.write(location.href, "Address copied", "Could not copy; the link is in the address bar");
    },
    async upload({ target }) {
      const files = [...target.files];
      target.value = "";
      for (const file of files) {
        const path = `/upload/${this.client}?name=${encodeURIComponent(file.name.slice(-200))}`;
        const answer = await fetch(path, { method: "POST", body: file }).catch(() => null);
        if (!answer?.ok) say(answer?.status === 413 ? await answer.text() : `${file.name} could not be sent; reload the page.`);
      }
    },
    async download(kind) {
      const answer = await fetch(`/download/${this.client}/${kind}`).catch(() => null);
      if (!answer?.ok) {
        if (answer?.status !== 409) say("The file could not be made; reload the page.");
        return;
      }
      const anchor = document.createElement("a");
      anchor.href = URL.createObjectURL(await answer.blob());
      anchor.download = decodeURIComponent(answer.headers.get("x-file-name"));
      anchor.click();
      // At once would be too early: the browser may not have begun to read it.
      setTimeout(() => URL.revokeObjectURL(anchor.href), 60000);
    },
  },
};
