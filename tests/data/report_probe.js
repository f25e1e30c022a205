// Uses the viewer of a report as a reader does, and leaves what it has seen in #probe.
(async () => {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  const seen = {};
  const over = () => document.querySelector("#frame-plot .u-over");
  const fire = (kind, fx, fy) => {
    const box = over().getBoundingClientRect();
    const at = { clientX: box.left + fx * box.width, clientY: box.top + fy * box.height, bubbles: true, button: 0, buttons: 1, movementX: 1, movementY: 1 };
    (kind === "mouseup" ? document : over()).dispatchEvent(new MouseEvent(kind, at));
  };
  const read = async (fx) => { fire("mouseenter", fx, 0.5); fire("mousemove", fx, 0.5); await pause(60); return document.getElementById("frame-values").textContent; };
  seen.before = [await read(0.1), await read(0.9)];
  fire("mousedown", 0.4, 0.2); fire("mousemove", 0.45, 0.5); await pause(30); fire("mousemove", 0.6, 0.8); await pause(60); fire("mouseup", 0.6, 0.8);
  await pause(60);
  seen.zoomed = [await read(0.1), await read(0.9)];
  over().dispatchEvent(new MouseEvent("dblclick", { bubbles: true }));
  await pause(60);
  seen.reset = [await read(0.1), await read(0.9)];
  seen.last = document.getElementById("time-text").textContent;
  const slider = document.getElementById("time");
  slider.value = 0; slider.dispatchEvent(new Event("input")); await pause(60);
  seen.first = document.getElementById("time-text").textContent;
  const quantity = document.getElementById("quantity");
  quantity.selectedIndex = quantity.options.length - 1;
  quantity.dispatchEvent(new Event("change"));
  await pause(60);
  seen.chosen = quantity.selectedOptions[0].textContent;
  seen.legend = document.getElementById("frame-legend").textContent;
  const out = document.createElement("pre"); out.id = "probe"; out.textContent = JSON.stringify(seen); document.body.append(out);
})();
