// Talking to the studio: requests that say why they failed, and sockets that come back.

let page = null;
export const pageName = () => page;

export class Refused extends Error {}

export async function call(method, path, body) {
  const raw = body instanceof Blob;
  const headers = page ? { "X-Studio-Page": page } : {};
  if (body !== undefined && !raw) headers["Content-Type"] = "application/json";
  let answer;
  try {
    answer = await fetch(path, { method, headers, body: raw ? body : JSON.stringify(body) });
  } catch {
    throw new Refused("the studio does not answer");
  }
  const type = answer.headers.get("content-type") ?? "";
  const data = type.includes("json") ? await answer.json() : {};
  if (!answer.ok) throw new Refused(data.why ?? data.error ?? `refused (${answer.status})`);
  return data;
}

export const get = (path) => call("GET", path);
export const post = (path, body = {}) => call("POST", path, body);

function socketUrl(path) {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;
}

// A socket that reconnects by itself; `hooks`: open, message(data), closed.
function lasting(path, hooks) {
  let socket = null, wait = 250;
  const open = () => {
    socket = new WebSocket(socketUrl(path));
    socket.onopen = () => { wait = 250; hooks.open?.(); };
    socket.onmessage = (event) => hooks.message(JSON.parse(event.data));
    socket.onclose = () => { hooks.closed?.(); setTimeout(open, wait); wait = Math.min(2000, wait * 2); };
  };
  open();
  return { send: (value) => socket?.readyState === 1 && (socket.send(JSON.stringify(value)), true) };
}

export const ticks = (onTick) => lasting("/api/ticks", { message: onTick });

// The page's own line, kept by a worker (pace.js): twenty heartbeats a second with the keys held
// down, and the emergency stop, past every request that may be waiting. By HTTP, if it is down.
export function controlLine({ onState, onLink, heldKeys }) {
  let roundTrip = 0;
  const worker = new Worker("/assets/js/pace.js");
  const say = () => worker.postMessage({ type: "said", said: { keys: heldKeys(), visible: !document.hidden } });
  worker.onmessage = ({ data }) => {
    if (data.type === "ping") worker.postMessage({ type: "pong" });
    else if (data.type === "state") { page = data.page; roundTrip = data.roundTrip; onState(data); }
    else if (data.type === "link") { if (data.link === "down") page = null; onLink(data.link); }
    else if (data.type === "unsent-stop") post("/api/stop").catch(() => {});
  };
  document.addEventListener("visibilitychange", say);
  worker.postMessage({ type: "open", url: socketUrl("/api/control") });
  return {
    say,
    stop: () => worker.postMessage({ type: "stop" }),
    get roundTrip() { return roundTrip; },
  };
}
