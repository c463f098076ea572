"""The inputs of files, which the browser sends to the server one after the other."""

from collections.abc import Awaitable, Callable

from nicegui import events, ui

from rockpulse.app.window import Window
from rockpulse.views.shared.words import error_words, say

#: Sends the chosen or dropped files, also those in folders, one after the other, and reports the file that is sent and,
#: at the end, the faults.
SEND = """async (event) => { event.preventDefault(); const faults = [], files = [];
  const inside = async (entry) => { if (!entry || entry.name.startsWith(".")) return;
    if (entry.isFile) files.push([entry.fullPath, await new Promise((found, fault) => entry.file(found, fault))]);
    else for (const reader = entry.createReader(); ;) {
      const some = await new Promise((found, fault) => reader.readEntries(found, fault)); if (!some.length) return;
      for (const one of some) await inside(one); } };
  if (event.dataTransfer) for (const entry of [...event.dataTransfer.items].map((one) => one.webkitGetAsEntry()))
    await inside(entry).catch((fault) => faults.push(`${entry.name}: ${fault}`));
  else files.push(...[...event.target.files].map((file) => [file.webkitRelativePath || file.name, file]));
  for (const [name, file] of files.filter(([name]) => !/[/][.]/.test(name))) { emit({sending: file.name, faults});
    try { const answer = await fetch(`/upload/KIND?name=${encodeURIComponent(name)}`, {method: "POST", body: file});
      if (!answer.ok) faults.push(`${name}: ${await answer.text()}`); }
    catch (fault) { faults.push(`${name}: ${fault}`); } }
  if (!event.dataTransfer) event.target.value = ""; emit({sending: "", faults}); }"""


def file_input(page: Window, label: str, kind: str, done: Callable[[], Awaitable[None]], folder: str = "") -> None:
    """Show an input for files and, with the label `folder`, one for a folder; `done` is called after each upload."""

    async def sent(event: events.GenericEventArguments) -> None:
        page.sending = bool(event.args["sending"])
        state.text = say("app.records.copying", name=event.args["sending"]) if page.sending else ""
        if not page.sending:
            await done()
            for name, _, fault in (one.partition(": ") for one in event.args["faults"]):
                shown = f"{name}: {error_words(fault.removeprefix(f'{name}: '))}"
                ui.notify(shown, type="negative", multi_line=True, close_button=True, timeout=0)

    handle, send = page.handler(sent), SEND.replace("KIND", kind)
    with ui.element("div").classes("drop").on("dragover", js_handler="(event) => event.preventDefault()") as field:
        field.on("drop", handle, js_handler=send)
        for text, several in ((label, "multiple"), (folder, "webkitdirectory")):
            if text:
                with ui.element("label"):
                    ui.label(text)
                    ui.element("input").props(f'type="file" {several}').on("change", handle, js_handler=send)
    state = ui.label().props('role="status"')
