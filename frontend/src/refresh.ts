// The dashboard looks again every few seconds: the parts with the attribute `data-part` are taken
// from a fresh copy of the page. Not while somebody is in one of them, or the window is hidden.

const parts = () => document.querySelectorAll<HTMLElement>("[data-part]");

async function look(): Promise<void> {
  const answer = await fetch(location.href, { credentials: "same-origin" });
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  const fresh = new DOMParser().parseFromString(await answer.text(), "text/html");
  for (const part of parts()) {
    const name = part.dataset["part"] ?? "";
    const other = fresh.querySelector(`[data-part="${CSS.escape(name)}"]`);
    if (other && !part.contains(document.activeElement)) part.replaceChildren(...other.childNodes);
  }
}

const seconds = Number(document.querySelector<HTMLElement>("[data-refresh]")?.dataset["refresh"]);
const follow = document.querySelector<HTMLInputElement>("#follow");
const words = document.querySelector<HTMLElement>("#followed");
if (seconds > 0 && follow && words) {
  follow.hidden = words.hidden = false;
  const said = words.textContent ?? "";
  window.setInterval(() => {
    if (!follow.checked || document.hidden) return;
    look().then(
      () => (words.textContent = said),
      (error: unknown) => (words.textContent = `Could not look again: ${String(error)}`),
    );
  }, 1000 * seconds);
}
