// Pages with a form: what is filled in survives a reload, and going back never asks to send again.

const NAME = "coadapt.draft";

interface Draft {
  stage: string;
  fields: [string, string][];
}

function storage<Result>(use: (kept: Storage) => Result): Result | null {
  try {
    return use(sessionStorage);
  } catch {
    // The browser keeps nothing for this page.
    return null;
  }
}

/** What was filled in on the page of `stage` and not sent yet. */
function draft(stage: string): Draft["fields"] {
  const kept = storage((storage) => storage.getItem(NAME));
  try {
    const found = JSON.parse(kept ?? "null") as Draft | null;
    return found?.stage === stage ? found.fields : [];
  } catch {
    return [];
  }
}

function restore(form: HTMLFormElement, fields: Draft["fields"]): void {
  for (const [name, value] of fields) {
    for (const field of form.querySelectorAll<HTMLInputElement | HTMLTextAreaElement>("input, textarea")) {
      if (field.name !== name || field.type === "hidden") continue;
      if (field instanceof HTMLTextAreaElement) field.value ||= value;
      else if (field.type === "radio" && field.value === value) field.checked = true;
    }
  }
}

// A form that was sent back with a problem is the answer to a post. As an entry of its own the page
// is fetched when someone comes back to it, and shows where the session stands.
history.replaceState(null, "", location.href);

const form = document.querySelector<HTMLFormElement>("main form");
const stage = document.body.dataset["stage"];
if (form && stage) {
  restore(form, draft(stage));
  form.addEventListener("input", () => {
    const fields = [...new FormData(form)].flatMap(([name, value]): Draft["fields"] =>
      typeof value === "string" && name !== "csrf" ? [[name, value]] : [],
    );
    storage((storage) => storage.setItem(NAME, JSON.stringify({ stage, fields } satisfies Draft)));
  });
}
