// The text of the definition as a tree: places and values of paths.

const { ensureSyntaxTree, syntaxTree } = CodeMirror;
/** Longest time that a text is parsed at once [ms]. */
const PARSED = 500;

/** The value of an object's key in the tree. Undefined if there is none. */
function member(state, object, key) {
  if (object?.name !== "Object") return undefined;
  for (const property of object.getChildren("Property")) {
    const name = property.getChild("PropertyName");
    // The last child is the value, unless it is not written yet.
    if (name && read(state, name) === key) return property.lastChild === name || property.lastChild.name === "⚠" ? undefined : property.lastChild;
  }
  return undefined;
}

/** Node of the value at a path of keys and indices. */
function nodeAt(state, path) {
  let node = (ensureSyntaxTree(state, state.doc.length, PARSED) ?? syntaxTree(state)).topNode.firstChild;
  for (const step of path) node = typeof step === "number" ? elements(node)[step] : member(state, node, step);
  return node;
}

function elements(list) {
  const all = [];
  for (let node = list?.name === "Array" ? list.firstChild : null; node; node = node.nextSibling) if (!/[\[\],⚠]/.test(node.name)) all.push(node);
  return all;
}

/** The value at a node. Undefined if it is no JSON. */
function read(state, node) {
  try {
    return node && JSON.parse(state.sliceDoc(node.from, node.to));
  } catch {
    return undefined;
  }
}

/** Keys of the objects around a place, starting with the outermost. */
function pathOf(state, node) {
  const path = [];
  for (; node?.parent; node = node.parent) {
    if (node.parent.name === "Property" && node.name !== "PropertyName") path.unshift(read(state, node.parent.getChild("PropertyName")));
    if (node.parent.name === "Array") path.unshift(elements(node.parent).findIndex(({ from }) => from === node.from));
  }
  return path;
}
