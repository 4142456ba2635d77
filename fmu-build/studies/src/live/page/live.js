// The page and its server: the page sends text and values, and receives data.

const first = JSON.parse(byId("live-first").textContent);
/** Time after which the page repeats its request for a new version when the server has not answered [ms]. */
const AGAIN = 1000;
/** The last text with a motion: its data, and the text as an object. */
const good = {};
const file = { version: first.version, text: plain(first.text) };
/** Runs: whether one is active, whether another is requested, number of shown runs. */
const runs = { isOut: false, isWanted: false, shown: 0, last: undefined };

const editor = new Editor(byId("live-text"), first.text, onEdit, save);
const knobs = new Knobs(byId("knobs"), run);
const handles = new Handles({ begin: beginDrag, change: (handle, numbers) => editor.change(changesOf(handle, numbers), false), end: endDrag });

const isDirty = () => editor.text !== file.text;
/** Whether the page asks which of two texts to keep. */
const asks = () => !byId("live-conflict").hidden;

async function ask(path, body, signal) {
  const options = body && { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  const answer = await fetch(path, { cache: "no-store", signal, ...options });
  if (!answer.ok) throw new Error((await answer.text()).slice(0, 500));
  return answer.json();
}

/** Run the text with the values of the sliders. During a run, only the newest text waits. */
async function run() {
  if (runs.isOut) return void (runs.isWanted = true);
  runs.isOut = true;
  do {
    runs.isWanted = false;
    const { text } = editor;
    let reply;
    try {
      reply = await ask("run", { text, values: [...knobs.values] });
      showConnection();
    } catch (error) {
      showConnection(error);
      continue;
    }
    try {
      apply(reply.data, reply.notes, text);
    } catch {
      // The last motion belongs to a mechanism with other parts.
      good.data = undefined;
      apply(reply.data, reply.notes, text);
    }
  } while (runs.isWanted);
  runs.isOut = false;
}

/** Show what a text gives. */
function apply(data, notes, text) {
  const isGood = Boolean(data.motion);
  let root;
  try {
    root = JSON.parse(text);
  } catch {
    root = undefined;
  }
  if (isGood) Object.assign(good, { data, root });
  else if (root) good.root = root;
  const isStale = !isGood && Boolean(good.data);
  const playing = mechanism.clock?.isPlaying;
  const what = isStale ? overGood(data, good.data) : data;
  handles.set(root, what);
  const hadError = !byId("error").hidden;
  document.body.classList.toggle("stale", isStale);
  if (runs.shown) mechanism.show(what);
  if (isStale) byId("error-title").textContent = `${what.wrong && !data.still.is_assembled ? "The loops do not close" : "No motion"}; the drawing shows the last motion in grey`;
  if (hadError === byId("error").hidden) editor.keepInSight();
  if (playing) mechanism.clock?.play(true);
  knobs.update(notes.knobs);
  byId("live-knobs-problem").textContent = brief(notes.problems.join("; "));
  // In an older text the places differ.
  if (text === editor.text) editor.mark(notes.marks);
  showFindings(notes.marks);
  runs.shown += 1;
  runs.last = { text, milliseconds: notes.milliseconds, at: performance.now() };
}

function showFindings(marks) {
  const count = (is) => marks.filter((mark) => mark.is_error === is).length;
  const words = (n, word) => (n ? `${n} ${word}${n === 1 ? "" : "s"}` : "");
  const button = byId("live-findings");
  button.textContent = [words(count(true), "error"), words(count(false), "warning")].filter(Boolean).join(", ") || "No findings";
  button.disabled = !marks.length;
  button.classList.toggle("error", count(true) > 0);
  button.onclick = () => editor.goTo(marks[0].from, marks[0].to);
}

function showConnection(error = file.error) {
  byId("live-lost").hidden = !error;
  if (error) byId("live-lost").textContent = error instanceof TypeError ? "The command has ended. This page still contains your text: start the command again, and copy the text into the new page." : error.message;
}

function showState() {
  byId("live-state").textContent = isDirty() ? "Not saved" : "Saved";
  byId("live-save").disabled = !isDirty() || asks();
  byId("live-undo").disabled = !CodeMirror.undoDepth(editor.state);
  byId("live-redo").disabled = !CodeMirror.redoDepth(editor.state);
}

function onEdit() {
  showState();
  run();
}

async function save() {
  if (!isDirty() || asks()) return;
  const [text, written] = [editor.text, editor.written];
  try {
    file.saving = text;
    const reply = await ask("save", { text: written, version: file.version });
    file.error = undefined;
    showConnection();
    if ("text" in reply || "error" in reply) onNews(reply);
    else if (reply.version > file.version) Object.assign(file, { version: reply.version, text });
  } catch (error) {
    showConnection(error);
  }
  file.saving = undefined;
  showState();
}

/** The version of the file differs from that of the page. */
function onNews({ version, text, error }) {
  if (version === file.version) return;
  byId("live-conflict").hidden = true;
  file.error = error && new Error(error);
  showConnection();
  if (error !== undefined) {
    // There is no file with this text.
    Object.assign(file, { version, text: undefined });
    return void showState();
  }
  const other = plain(text);
  const wasDirty = isDirty();
  const isOwn = other === file.saving || other === file.text;
  file.version = version;
  // The present text of the file. The text of the page may be newer.
  file.text = other;
  if (!wasDirty) editor.replace(text);
  else if (!isOwn && isDirty()) {
    file.news = text;
    byId("live-conflict").hidden = false;
  }
  showState();
  // A file of parameters may have changed without a change of the text.
  if (!wasDirty || isOwn) run();
}

async function listen() {
  let seen;
  document.addEventListener("visibilitychange", () => seen?.abort());
  for (;;) {
    // A browser has few connections to one server: a hidden page uses none.
    while (document.hidden) await new Promise((resolve) => document.addEventListener("visibilitychange", resolve, { once: true }));
    seen = new AbortController();
    try {
      const reply = await ask(`file?after=${file.version}`, undefined, seen.signal);
      showConnection();
      onNews(reply);
    } catch (error) {
      if (seen.signal.aborted) continue;
      showConnection(error);
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
    }
  }
}

/** The change that writes these numbers at the path of a handle, and of the handles connected with it. */
function changesOf(handle, numbers) {
  return [handle, ...(handle.others ?? [])].flatMap(({ path }) => {
    const node = nodeAt(editor.state, path);
    const nodes = numbers.length === 1 ? [node].filter(Boolean) : elements(node);
    return nodes.map((one, k) => ({ from: one.from, to: one.to, insert: String(numbers[k]) })).filter(({ from, to, insert }) => editor.state.sliceDoc(from, to) !== insert);
  });
}

function beginDrag() {
  file.beforeDrag = editor.text;
}

/** A drag is one step of the history: intermediate changes are undone first. */
function endDrag(handle, numbers) {
  editor.replace(file.beforeDrag, false);
  if (numbers) editor.change(changesOf(handle, numbers));
}

document.body.classList.add("with-text");
// Below the text, so that text and drawing keep their positions.
byId("live-text").after(byId("error"));
byId("live-file").textContent = first.shown.split(/[\\/]/).pop();
byId("live-file").title = first.shown;
byId("live-save").addEventListener("click", save);
for (const [id, command] of [["live-undo", CodeMirror.undo], ["live-redo", CodeMirror.redo]]) {
  byId(id).addEventListener("click", () => {
    command(editor.view);
    editor.view.focus();
  });
}
byId("live-take-theirs").addEventListener("click", () => {
  byId("live-conflict").hidden = true;
  editor.replace(file.news);
  showState();
});
byId("live-keep-mine").addEventListener("click", () => {
  byId("live-conflict").hidden = true;
  showState();
});
// Keys in the text and on the sliders do not control the drawing.
byId("live").addEventListener("keydown", (event) => event.stopPropagation());
addEventListener("beforeunload", (event) => isDirty() && event.preventDefault());
file.error = first.error && new Error(first.error);
showConnection();
apply(mechanism.data, first.notes, editor.text);
showState();
listen();
mechanism.live = { editor, knobs, handles, runs, file };
