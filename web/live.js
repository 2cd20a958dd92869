// The live connection: requests an update, receives it, requests the next one. Reconnects by itself.
// An update is a picture and the tasks' times, where there are new ones, and ends with a state.

const RETRY_MS = [300, 500, 1000, 2000];
const SILENCE_MS = 3000; // the service sends at least four updates a second
const HEADER_BYTES = 12;

/**
 * Keep a live connection. onUpdate(state, picture, times) is called for every update, picture is null or
 * {number, grabbed_s, bitmap}, times are null or as of the topic timing; onLink(open, reason) when the link opens or
 * is lost.
 */
export function connect(onUpdate, onLink) {
  let socket = null;
  let failures = 0;
  let watchdog = 0;
  let retry = 0;

  function open() {
    clearTimeout(retry);
    const mine = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live?topics=picture,timing,state`);
    let picture = null;
    let times = null;
    socket = mine;
    mine.binaryType = "arraybuffer";
    mine.onopen = () => {
      failures = 0;
      onLink(true, "");
      mine.send("next");
      guard(mine);
    };
    mine.onmessage = async ({ data }) => {
      guard(mine);
      if (data instanceof ArrayBuffer) {
        picture = decoded(data);
        return;
      }
      const message = JSON.parse(data);
      if (message.topic === "timing") {
        times = message;
        return;
      }
      const newest = await picture;
      if (mine !== socket) return;
      onUpdate(message, newest, times);
      if (mine.readyState === WebSocket.OPEN) mine.send("next");
    };
    mine.onclose = ({ reason }) => {
      if (mine === socket) lost(reason);
    };
  }

  function lost(reason) {
    clearTimeout(watchdog);
    clearTimeout(retry);
    socket = null;
    onLink(false, reason);
    if (document.hidden) return; // the page is hidden: the service need not make pictures for it
    retry = setTimeout(open, RETRY_MS[Math.min(failures++, RETRY_MS.length - 1)]);
  }

  function guard(mine) {
    clearTimeout(watchdog);
    watchdog = setTimeout(() => drop(mine), SILENCE_MS);
  }

  function drop(mine) {
    if (mine !== socket) return;
    mine.close();
    lost("");
  }

  document.addEventListener("visibilitychange", () => {
    if (document.hidden && socket) drop(socket);
    if (!document.hidden && !socket) open();
  });
  open();
}

/** The picture of a binary message; null when it cannot be decoded. */
async function decoded(message) {
  const header = new DataView(message, 0, HEADER_BYTES);
  const jpeg = new Blob([new Uint8Array(message, HEADER_BYTES)], { type: "image/jpeg" });
  try {
    const bitmap = await createImageBitmap(jpeg);
    return { number: header.getUint32(0, true), grabbed_s: header.getFloat64(4, true), bitmap };
  } catch {
    return null;
  }
}
