// The page's own line, in a worker: drawing may hold up the page, never the heartbeat. It beats
// twenty times a second for as long as the page itself answers; a page that hangs is a lost page.

const HANGS = 5000; // ms without a word from the page
let url = null, socket = null, wait = 250, roundTrip = 0, heard = performance.now();
let said = { keys: [], visible: true };

function open() {
  socket = new WebSocket(url);
  socket.onopen = () => { wait = 250; postMessage({ type: "link", link: "up" }); };
  socket.onclose = () => {
    postMessage({ type: "link", link: "down" });
    setTimeout(open, wait);
    wait = Math.min(2000, 2 * wait);
  };
  socket.onmessage = (event) => {
    const message = JSON.parse(event.data);
    if (message.type === "beat") roundTrip = performance.now() - message.sent;
    else postMessage({ ...message, roundTrip });
  };
}

function send(message) {
  if (socket?.readyState !== 1) return false;
  socket.send(JSON.stringify(message));
  return true;
}

function beat() {
  postMessage({ type: "ping" });
  if (performance.now() - heard < HANGS)
    send({ type: "beat", sent: performance.now(), round_trip_ms: roundTrip, ...said });
}

onmessage = ({ data }) => {
  heard = performance.now();
  if (data.type === "open") { url = data.url; open(); setInterval(beat, 50); }
  else if (data.type === "said") { said = data.said; beat(); }
  else if (data.type === "stop" && !send({ type: "stop" })) postMessage({ type: "unsent-stop" });
};
