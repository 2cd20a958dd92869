// Copies text for another program.

import { complain, say } from "./toasts";

export async function copy(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    say("Copied.");
  } catch {
    complain("The browser does not let the page copy; mark the text and copy it by hand.");
  }
}
