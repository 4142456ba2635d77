// Completions and explanations, from the schema of the definition.

const schema = JSON.parse(byId("live-schema").textContent);
/** Keys whose values name a part of the definition, with the key of these parts. */
const NAMES = { body: "bodies", first_body: "bodies", second_body: "bodies", on: "bodies", stop: "stops" };

/** A schema with resolved references. Of several kinds of value, the one that is an object or a list. */
function resolved(part) {
  let [out, text] = [part, part?.description];
  for (let k = 0; out?.$ref && k < 8; k++) {
    out = schema.$defs[out.$ref.split("/").pop()];
    text ??= out?.description;
  }
  const kinds = out?.oneOf ?? out?.anyOf;
  const kind = kinds?.map(resolved).find((one) => one?.properties ?? one?.items ?? one?.additionalProperties);
  return out && { ...out, ...(kind ?? {}), description: text, $ref: undefined, isPoint: part.$ref?.endsWith("/point") };
}

/** The schema of the value at a path. */
function schemaAt(path) {
  let part = resolved(schema);
  for (const key of path) {
    const below = typeof key === "number" ? (part?.prefixItems?.[key] ?? part?.items) : (part?.properties?.[key] ?? part?.additionalProperties);
    if (!below || typeof below !== "object") return undefined;
    part = resolved(below);
  }
  return part;
}

/** Points of all bodies, as joints name them. */
function points(root) {
  return Object.entries(root?.bodies ?? {}).flatMap(([body, { length, drawn, points } = {}]) => {
    const ends = length !== undefined || drawn?.end ? ["origin", "end"] : ["origin"];
    return [...ends, ...Object.keys(points ?? {}), ...Object.keys(drawn?.points ?? {})].map((point) => `${body}.${point}`);
  });
}

/** The text of an initial value. */
function template(part) {
  if (part.properties || part.additionalProperties) return "{}";
  if (part.items || part.prefixItems) return "[]";
  const of = [part.type].flat();
  if (of.includes("number")) return typeof part.default === "number" ? String(part.default) : "0";
  if (of.includes("boolean")) return String(part.default ?? true);
  return '""';
}

function complete(context) {
  const { state, pos } = context;
  const tree = ensureSyntaxTree(state, pos, PARSED) ?? syntaxTree(state);
  const at = tree.resolveInner(pos, -1);
  const property = at.name === "Property" ? at : at.parent?.name === "Property" ? at.parent : undefined;
  if (at.name === "PropertyName" || (["Object", "{", "⚠"].includes(at.name) && !afterColon(state, pos))) return completeKey(context, at);
  if (property || at.name === "Array" || at.parent?.name === "Array") return completeValue(context, at, property);
  return null;
}

/** Whether a value is expected here, and not a key. */
const afterColon = (state, pos) => /:\s*$/.test(state.sliceDoc(Math.max(pos - 200, 0), pos));

function completeKey(context, at) {
  const { state, pos } = context;
  let object = at;
  while (object && object.name !== "Object") object = object.parent;
  const part = schemaAt(pathOf(state, object ?? at));
  if (!part?.properties) return null;
  const isKey = at.name === "PropertyName";
  if (!isKey && !context.explicit) return null;
  const there = new Set((object?.getChildren("Property") ?? []).map((one) => read(state, one.getChild("PropertyName"))));
  const hasValue = isKey && /^\s*:/.test(state.sliceDoc(at.to, at.to + 20));
  const options = Object.entries(part.properties).filter(([key]) => !there.has(key)).map(([key, below]) => {
    const of = resolved(below);
    const value = hasValue ? "" : `: ${template(of)}`;
    return {
      label: `"${key}"`, displayLabel: key, type: "property", info: explained(of), boost: part.required?.includes(key) ? 5 : 0,
      apply: (view, _, from, to) => {
        const insert = `"${key}"${value}`;
        // The cursor moves into the value.
        const inside = insert.length - (/[\]}"]$/.test(value) ? 1 : 0);
        view.dispatch({ changes: { from, to, insert }, selection: { anchor: from + inside } });
      },
    };
  });
  return { from: isKey ? at.from : pos, to: isKey ? at.to : pos, options, validFor: /^"?[\w$]*"?$/ };
}

function completeValue(context, at, property) {
  const { state, pos } = context;
  const isText = at.name === "String";
  const path = pathOf(state, isText || !property ? at : property.lastChild);
  if (property && !isText && property.lastChild.name === "PropertyName") path.push(read(state, property.getChild("PropertyName")));
  const part = schemaAt(path);
  if (!part) return null;
  const root = good.root ?? {};
  const key = path.at(-1);
  const named = key === "joint" ? Object.keys(root.joints ?? {}) : Object.keys(root[NAMES[key]] ?? {});
  const words = part.enum ?? (part.const !== undefined ? [part.const] : [part.type].flat().includes("boolean") ? [true, false] : part.isPoint ? points(root) : named);
  if (!words.length || (!isText && !context.explicit && !afterColon(state, pos))) return null;
  const options = words.map((word) => ({ label: JSON.stringify(word), displayLabel: String(word), type: "enum" }));
  return { from: isText ? at.from : pos, to: isText ? at.to : pos, options, validFor: /^"?[\w.]*"?$/ };
}

/** The description in a schema, for a completion or a hover. */
function explained(part) {
  const words = [part?.description];
  if (part?.enum) words.push(`One of: ${part.enum.join(", ")}.`);
  if (part?.default !== undefined && typeof part.default !== "object") words.push(`Default: ${part.default}.`);
  return words.filter(Boolean).join("\n");
}

const explainedOnHover = CodeMirror.hoverTooltip((view, pos, side) => {
  const node = syntaxTree(view.state).resolveInner(pos, side);
  if (node.name !== "PropertyName") return null;
  const path = [...pathOf(view.state, node.parent), read(view.state, node)];
  const text = explained(schemaAt(path));
  if (!text) return null;
  const create = () => {
    const dom = document.createElement("div");
    dom.className = "explained";
    dom.textContent = text;
    return { dom };
  };
  return { pos: node.from, end: node.to, create };
});
