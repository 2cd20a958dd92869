import { createApp } from "vue";

import App from "./App.vue";
import { startLive } from "./live/service";
import { loadMe, logIn } from "./live/session";
import { makeRouter } from "./router";
import "./style.css";
import { complain } from "./widgets/toasts";
import { refuse } from "./widgets/changes";

/** The link of a first start or of a team holds a secret: it is exchanged for a session and leaves the address bar. */
async function takeSecret(): Promise<void> {
  const address = new URL(location.href);
  const secret = address.searchParams.get("token") ?? address.searchParams.get("key");
  if (!secret) return;
  address.searchParams.delete("token");
  address.searchParams.delete("key");
  history.replaceState(null, "", address);
  try {
    await logIn(secret);
  } catch (error) {
    refuse(error);
  }
}

async function begin(): Promise<void> {
  await takeSecret();
  await loadMe();
  startLive();
  const app = createApp(App).use(makeRouter());
  app.config.errorHandler = (error) => {
    complain(`The page has a fault: ${error instanceof Error ? error.message : String(error)}`);
    console.error(error);
  };
  app.mount("#app");
}

void begin();
