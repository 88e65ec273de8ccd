// The plan as an HTML form behind the result in words: for screen readers, voice control and browsers' own fields, which
// reach nothing on the app's canvas. The form is shown while a field of it has the focus.

const form = document.getElementById("implant-preview-form");
/** The rows of the form by the names of their fields. */
const rows = new Map();

function element(tag, properties = {}, children = []) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

function selection(choices) {
  const none = element("option", { value: "", textContent: "–", disabled: true });
  return element("select", {}, [none, ...choices.map((value) => element("option", { value }))]);
}

/** The input of a choice, of a text of one line or several, or of a number. */
function createInput({ choices, characters, lines }) {
  if (choices) return selection(choices);
  if (!characters) return element("input", { inputMode: "decimal", autocomplete: "off" });
  const properties = { maxLength: characters, autocomplete: "off" };
  return lines > 1 ? element("textarea", { rows: 3, ...properties }) : element("input", properties);
}

/** A row with label, input, allowed values and error. */
function createRow(field) {
  const { name } = field;
  const id = `plan-${name}`;
  const input = createInput(field);
  Object.assign(input, { id, name, value: "" });
  input.setAttribute("aria-describedby", `${id}-range ${id}-hint ${id}-error`);
  const parts = {
    label: element("label", { htmlFor: id }),
    input,
    range: element("small", { id: `${id}-range` }),
    hint: element("small", { id: `${id}-hint`, hidden: true }),
    error: element("small", { id: `${id}-error`, className: "error" }),
  };
  parts.error.setAttribute("role", "alert");
  const row = { ...parts, shown: "", element: element("div", {}, Object.values(parts)) };
  input.addEventListener("change", () => commit(row));
  input.addEventListener("keydown", ({ key }) => {
    // In a text of several lines the Enter key begins a line.
    if (key === "Enter" && input.localName !== "textarea") commit(row);
    if (key === "Escape") reset(row);
  });
  rows.set(name, row);
  form.append(row.element);
  return row;
}

function setError(row, text) {
  row.error.textContent = text;
  row.input.setAttribute("aria-invalid", String(text !== ""));
}

function reset(row) {
  row.input.value = row.shown;
  setError(row, "");
}

/** Sets the field of the plan; a refused text stays with its reason. */
function commit(row) {
  try {
    globalThis.implantPreview.setPlan(row.input.name, row.input.value);
  } catch (error) {
    setError(row, error.message);
    return;
  }
  reset(row);
  show(globalThis.implantPreview.plan());
}

/** Sets the texts of a row, which are those of the language of the moment. */
function translate(row, { label, unit, hint, range, words }) {
  row.label.textContent = unit ? `${label} (${unit})` : label;
  row.hint.textContent = hint;
  row.range.textContent = range;
  words?.forEach((word, k) => Object.assign(row.input.options[k + 1], { textContent: word }));
}

/** Shows the fields of a plan (JSON text). Text that is being typed stays. */
function show(plan) {
  const fields = JSON.parse(plan);
  for (const field of fields) {
    const row = rows.get(field.name) ?? createRow(field);
    const isTyped = row.input.value !== row.shown;
    translate(row, field);
    row.shown = field.text;
    if (!isTyped) reset(row);
  }
  const names = new Set(fields.map(({ name }) => name));
  for (const [name, row] of rows) row.element.hidden = !names.has(name);
}

form.addEventListener("submit", (event) => event.preventDefault());

// Called by the app with each new plan.
globalThis.implantPreviewPlan = show;
