// A list to choose from, and fields for what the choice needs. Native elements, as in slider.js.
export default {
  props: { name: String, label: String, start: Object },
  template: `
    <div class="choice-row" v-show="!hidden" :data-choice="name">
      <label class="name" :for="'choice-' + name">{{ label }}</label>
      <select class="list" :id="'choice-' + name" :value="value" @change="$emit('pick', $event.target.value)">
        <option v-for="each in options" :key="each[0]" :value="each[0]">{{ each[1] }}</option>
      </select>
      <template v-for="each in details" :key="each[0]">
        <label class="detail" :for="'detail-' + name + '-' + each[0]">{{ each[1] }}</label>
        <input class="field" type="text" :id="'detail-' + name + '-' + each[0]" :name="each[0]" v-model="each[2]"
          :placeholder="each[3]" autocomplete="off" spellcheck="false" :aria-invalid="wrong === each[0] ? 'true' : 'false'"
          :aria-describedby="'choice-sentence-' + name"
          @keydown.enter="commit(each)" @keydown.esc="restore" @blur="commit(each)"
          @keydown.ctrl="each[2] === given[each[0]] || $event.stopPropagation()">
      </template>
      <div class="sentence" role="alert" :id="'choice-sentence-' + name">{{ sentence }}</div>
    </div>`,
  data() {
    return { ...this.fresh(this.start), sentence: "", wrong: "" };
  },
  methods: {
    fresh(now) {
      const details = now.details.map((each) => [...each]);
      return { ...now, details, given: Object.fromEntries(details.map((each) => [each[0], each[2]])) };
    },
    commit(each) {
      if (each[2] !== this.given[each[0]] || this.wrong === each[0]) this.$emit("commit", [each[0], each[2]]);
    },
    restore() {
      for (const each of this.details) each[2] = this.given[each[0]];
      this.sentence = this.wrong = "";
    },
    show(now) {
      Object.assign(this, this.fresh(now), { sentence: "", wrong: "" });
    },
    // What was refused: a choice, which goes back, or the text of one of its fields, which stays.
    complain(key, sentence) {
      this.sentence = sentence;
      this.wrong = key;
      if (!key) {
        const value = this.value;
        this.value = null;
        this.$nextTick(() => { this.value = value; });
      }
    },
  },
};
