// The API's documentation, drawn from openapi.json: no asset from elsewhere, since venues have no internet.

const api = await (await fetch("/openapi.json")).json();
document.getElementById("about").append(...prose(api.info.description));
for (const [path, methods] of Object.entries(api.paths)) {
  for (const [method, operation] of Object.entries(methods)) {
    document.getElementById("operations").append(operationOf(path, method, operation));
  }
}
for (const [name, schema] of Object.entries(api.components?.schemas ?? {})) {
  document.getElementById("schemas").append(modelOf(name, schema));
}

/** An element with a class, text and children. */
function element(tag, look, ...children) {
  const made = document.createElement(tag);
  if (look) made.className = look;
  made.append(...children);
  return made;
}

/** Text in which what stands in `x` or ``x`` is code. */
function prose(text) {
  return text.split(/(``?)(.+?)\1/).reduce((parts, piece, index) => {
    if (index % 3 === 0) parts.push(piece);
    if (index % 3 === 2) parts.push(element("code", "", piece));
    return parts;
  }, []);
}

function operationOf(path, method, operation) {
  const body = element("div", "", element("p", "", ...prose(operation.description ?? "")));
  const sent = operation.requestBody?.content?.["application/json"]?.schema;
  if (sent) body.append(element("p", "", "Sent as JSON: ", element("code", "", typeOf(sent))));
  const rows = Object.entries(operation.responses).map(([status, response]) => {
    const kinds = Object.entries(response.content ?? {}).map(([media, content]) => `${media} ${typeOf(content.schema ?? {})}`);
    return row(status, kinds.join(", "), response.description);
  });
  body.append(table(["status", "content", "meaning"], rows));
  if (method === "get") body.append(...trial(path));
  const summary = element("summary", "", element("code", "method", method.toUpperCase()), element("code", "", path));
  summary.append(element("span", "", ...prose((operation.description ?? "").split(/(?<=[.?!])\s/)[0])));
  return element("details", "", summary, body);
}

/** A button that asks the running service, and the place for its answer. */
function trial(path) {
  const button = element("button", "try", "Ask the service");
  button.type = "button";
  const answer = element("div");
  button.addEventListener("click", async () => {
    if (path.endsWith(".jpg")) {
      const image = element("img");
      image.src = `${path}?${Date.now()}`;
      image.alt = "The newest picture";
      answer.replaceChildren(image);
      return;
    }
    const response = await fetch(path);
    const isJson = /json/.test(response.headers.get("content-type"));
    const text = isJson ? JSON.stringify(await response.json(), null, 2) : await response.text();
    answer.replaceChildren(element("pre", "", `${response.status}\n${text}`));
  });
  return [button, answer];
}

function modelOf(name, schema) {
  const summary = element("summary", "", element("code", "", name), element("span", "", ...prose((schema.description ?? "").split("\n")[0])));
  const rows = Object.entries(schema.properties ?? {}).map(([key, value]) => row(key, typeOf(value), value.description ?? ""));
  const body = schema.enum ? element("p", "", schema.enum.join(", ")) : table(["field", "type", "meaning"], rows);
  return element("details", "", summary, element("div", "", body));
}

function typeOf(schema) {
  if (schema.$ref) return schema.$ref.split("/").at(-1);
  if (schema.anyOf) return schema.anyOf.map(typeOf).join(" or ");
  if (schema.type === "array") return `list of ${schema.items ? typeOf(schema.items) : "anything"}`;
  return schema.type ?? schema.title ?? "";
}

function row(...cells) {
  return element("tr", "", ...cells.map((cell) => element("td", "", ...prose(cell))));
}

function table(titles, rows) {
  const head = element("tr", "", ...titles.map((title) => element("th", "", title)));
  return element("table", "", element("thead", "", head), element("tbody", "", ...rows));
}
