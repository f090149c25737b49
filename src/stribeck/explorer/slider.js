// A quantity: its name, a field, its unit and a slider. Native elements, so that keyboard, phone and screen reader know them.
// One change is on its way to the server at a time; while it is, only the last value is kept.
export default {
  props: { name: String, start: Object },
  template: `
    <div class="knob" v-show="!hidden" :class="{wrong: sentence}" :data-row="name">
      <label class="name" :for="'field-' + name">{{ label }}<i v-html="symbol"></i></label>
      <input class="field" type="text" :id="'field-' + name" :name="name" v-model="text" autocomplete="off" spellcheck="false"
        :aria-invalid="sentence ? 'true' : 'false'" :aria-describedby="'sentence-' + name"
        @keydown.enter="commit" @keydown.esc="restore" @blur="commit"
        @keydown.ctrl="text === given || $event.stopPropagation()">
      <select v-if="units.length" class="unit" :aria-label="'Unit of ' + label" :value="unit"
        @change="$emit('unit', $event.target.value)">
        <option v-for="each in units" :key="each" :value="each">{{ each.replace('*', '·') }}</option>
      </select>
      <input class="slider" type="range" :min="low" :max="high" step="0.01" v-model.number="place" :aria-label="label"
        :aria-valuetext="text + ' ' + unit"
        @input="slide" @pointerdown="held = true" @pointerup="held = false" @pointercancel="held = false">
      <div class="sentence" role="alert" :id="'sentence-' + name">{{ sentence }}</div>
    </div>`,
  data() {
    return { ...this.start, given: this.start.text, sentence: "", held: false, waiting: false, next: null };
  },
  methods: {
    slide() {
      if (this.waiting) {
        this.next = this.place;
        return;
      }
      this.waiting = setTimeout(this.free, 1000);
      this.$emit("slide", this.place);
    },
    free() {
      clearTimeout(this.waiting);
      this.waiting = false;
      if (this.next === null) return;
      this.place = this.next;
      this.next = null;
      this.slide();
    },
    commit() {
      if (this.text !== this.given || this.sentence) this.$emit("commit", this.text);
    },
    restore() {
      this.text = this.given;
      this.sentence = "";
    },
    // The server's view of this quantity; a slider that is being moved stays in the hand that moves it.
    show(now) {
      const { place, ...rest } = now;
      Object.assign(this, rest, { given: now.text, sentence: "" });
      if (!this.held && this.next === null) this.place = place;
    },
    complain(text, sentence) {
      this.text = text;
      this.sentence = sentence;
    },
  },
};
