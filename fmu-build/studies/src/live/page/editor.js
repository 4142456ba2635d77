// The editor: CodeMirror with help from the schema, and the findings of the check.

const { Annotation, EditorState, EditorView, Transaction } = CodeMirror;
/** Marks a change that the page makes itself. */
const byPage = Annotation.define();

class Editor {
  /** `edited` is called after each change of the text, `save` by the keys for saving. */
  constructor(parent, text, edited, save) {
    // The line ends of the file, which the text of the editor does not contain.
    this.end = text.includes("\r\n") ? "\r\n" : "\n";
    const c = CodeMirror;
    const keys = [
      { key: "Mod-s", run: () => (save(), true), preventDefault: true },
      ...c.closeBracketsKeymap, ...c.defaultKeymap, ...c.searchKeymap, ...c.historyKeymap, ...c.foldKeymap, ...c.completionKeymap, ...c.lintKeymap,
    ];
    const styles = c.HighlightStyle.define([
      { tag: c.tags.propertyName, color: "var(--key)" }, { tag: c.tags.string, color: "var(--text)" },
      { tag: [c.tags.number, c.tags.bool, c.tags.null], color: "var(--number)" },
    ]);
    const extensions = [
      c.lineNumbers(), c.foldGutter(), c.lintGutter(), c.highlightSpecialChars(), c.history(), c.drawSelection(), c.indentOnInput(), c.indentUnit.of("  "),
      c.bracketMatching(), c.closeBrackets(), c.highlightActiveLine(), c.highlightSelectionMatches(), c.syntaxHighlighting(styles), c.json(),
      c.autocompletion({ override: [complete] }), explainedOnHover, c.keymap.of(keys), EditorView.lineWrapping,
      EditorView.contentAttributes.of({ "aria-label": "Text of the definition", tabindex: "0" }),
      EditorView.updateListener.of((update) => update.docChanged && edited(update)),
    ];
    this.words = "[]";
    this.view = new EditorView({ parent, state: EditorState.create({ doc: text, extensions }) });
  }

  get state() {
    return this.view.state;
  }

  /** The text with one character at the end of each line. */
  get text() {
    return this.state.doc.toString();
  }

  /** The text with the line ends of the file. */
  get written() {
    return this.end === "\n" ? this.text : this.text.replaceAll("\n", this.end);
  }

  /** Replace the part of the text that differs, so that cursor and history are kept. */
  replace(text, isStep = true) {
    if (text.includes("\r\n")) this.end = "\r\n";
    const [before, after] = [this.text, plain(text)];
    const most = Math.min(before.length, after.length);
    let [from, end] = [0, 0];
    while (from < most && before[from] === after[from]) from++;
    while (end < most - from && before[before.length - 1 - end] === after[after.length - 1 - end]) end++;
    if (before !== after) this.change([{ from, to: before.length - end, insert: after.slice(from, after.length - end) }], isStep);
  }

  /** One step of the history, or a change outside of the history. */
  change(changes, isStep = true) {
    const step = isStep ? CodeMirror.isolateHistory.of("full") : Transaction.addToHistory.of(false);
    this.view.dispatch({ changes, annotations: [step, byPage.of(true)] });
  }

  /** Underline the findings of the check. */
  mark(marks) {
    const { doc } = this.state;
    const { length } = doc;
    const words = JSON.stringify(marks);
    // Unchanged marks would make the editor measure the page, which takes longer than the rest of a run.
    if (words === this.words && (doc === this.marked || !marks.length)) return;
    [this.words, this.marked] = [words, doc];
    const diagnostics = marks.map(({ from, to, is_error, message }) => ({
      from: Math.min(from, length), to: Math.min(Math.max(to, from + 1), length), severity: is_error ? "error" : "warning", message: brief(message),
    }));
    this.view.dispatch(CodeMirror.setDiagnostics(this.state, diagnostics));
  }

  /** Keep the cursor visible when the editor becomes smaller while the user types. */
  keepInSight() {
    if (this.view.hasFocus) this.view.dispatch({ effects: EditorView.scrollIntoView(this.state.selection.main.head) });
  }

  /** Show a place of the text. */
  goTo(from, to) {
    this.view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
    this.view.focus();
  }
}

/** A text in the form of the editor. */
const plain = (text) => text.replace(/\r\n?/g, "\n");
