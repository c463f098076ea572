"use strict";
// The part to explore: what is chosen, how time goes on, and what is said of it. It computes no motion.
(() => {
  const root = document.getElementById("explorer");
  if (!root) return;
  const data = JSON.parse(root.dataset.motions);
  const { words, bodies, records } = data;
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const fill = (text, fields = {}) => text.replace(/\{(\w+)\}/g, (_, name) => fields[name]);
  const language = document.documentElement.lang;
  const digits = (value, count) => {
    const shown = Math.abs(value) < 0.5 * 10 ** -count ? 0 : value; // no "-0.00"
    return shown.toLocaleString(language, { minimumFractionDigits: count, maximumFractionDigits: count });
  };
  const short = (value) => value.toLocaleString(language, { maximumSignificantDigits: 3 });
  const times = (factor) => fill(words.factor_value, { factor: short(factor) });
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const drawing = explorerDrawing;
  const { between, middle, peakOf, unpacked } = drawing;
  const GRAVITY = 9.80665;
  const STEP = 0.1; // seconds of the two buttons
  const AT_REST = 5e-4; // of the critical angle, beside what 16 bits leave of nothing

  // What is shown: a body, a record, its scene if there is one, which of its factors, and the time in columns.
  let body, record = -1, scene, at = 0, place = 0, playing = 0;
  // What is drawn of it: extremes of ground and rotation, the strongest ground, and what a cursor moves.
  let ground, rotation, strongest, charts = [], stage;

  const step = () => scene.steps[at];
  const seconds = (where) => scene.start + ((where + 0.5) / scene.columns) * (scene.end - scene.start);

  const drawChance = () => {
    const known = scene.curve !== null || scene.points.length > 0;
    part("probability").toggleAttribute("hidden", !known);
    part("caption").textContent = known ? words[scene.curve ? "curve" : "points"] : words.no_curve;
    if (known) drawing.chance(part("probability"), scene, at, times);
  };

  const draw = () => {
    ground = unpacked(scene.ground);
    rotation = step().rotation ? unpacked(step().rotation) : null;
    const shaken = ground.low[0] !== null, largest = rotation ? peakOf(rotation) : 0;
    strongest = peakOf(ground) || 1;
    const peak = short((strongest * step().factor) / GRAVITY);
    const ends = shaken ? [[strongest, peak], [-strongest, `−${peak}`]] : [];
    // A motion far below the critical angle is shown large.
    const reach = largest >= 0.3 ? Math.min(Math.max(1.15, 1.08 * largest), 1.6) : 1.3 * largest || 1.15;
    const level = reach > 1 ? 1 : largest, name = reach > 1 ? "α_c" : short(largest), line = reach > 1 ? "limit" : "";
    const levels = [[level, name, line], [-level, `−${name}`, line], [0, "0"]];
    const of = (time) => fill(words.seconds, { time: short(time) });
    const shown = { kind: "acceleration", title: words.ground, marks: ends, seconds: of };
    const turned = { kind: "angle", title: words.rotation, marks: levels, seconds: of };
    charts = [
      drawing.curve(part("ground"), scene, shaken ? ground : null, { height: 120, reach: strongest, ...shown }),
      drawing.curve(part("rotation"), scene, rotation, { height: 190, reach, ...turned }),
    ];
    stage = drawing.stage(part("stage"), body, words.push);
    drawChance();
    tell();
    show();
  };

  // Where the body is at the cursor: its angle in degrees, how to draw it, and what to say.
  const position = (fields) => {
    const found = rotation ? between(rotation, place) : 0;
    if (found === null) {
      let column = Math.floor(place);
      while (column > 0 && middle(rotation, column) === null) column--;
      const right = middle(rotation, column) > 0;
      fields.side = body.wall ? words.away : right ? words.right : words.left;
      return [right ? 90 : -90, "down", words.state_fallen];
    }
    if (Math.abs(found) < AT_REST) return [0, "", words.state_still];
    const angle = (found * body.alpha[found > 0 ? 0 : 1] * 180) / Math.PI, beyond = Math.abs(found) > 1;
    fields.side = body.wall ? words.away : found > 0 ? words.right : words.left;
    fields.rotation = digits(Math.abs(found), 3);
    fields.degrees = digits(Math.abs(angle), 2);
    fields.verdict = beyond ? words.beyond : words.rocking;
    return [angle, beyond ? "beyond" : "", words.state];
  };
  const show = () => {
    for (const chart of charts) chart.move(place);
    const now = between(ground, place), fields = { time: digits(seconds(place), 2) };
    fields.ground = now === null ? "-" : digits((now * step().factor) / GRAVITY, 2);
    const [angle, kind, text] = position(fields);
    // The arrow is the longer the stronger the ground, at most at the largest factor.
    const share = ((now ?? 0) / strongest) * (step().factor / scene.steps[scene.steps.length - 1].factor) ** 0.5;
    stage.move(angle, kind, share);
    const upright = { body: body.name, degrees: digits(Math.abs(angle), 1) };
    part("stage").setAttribute("aria-label", fill(words.stage, upright));
    part("state").textContent = step().reason || step().ends === "unresolved" ? "" : fill(text, fields);
    part("time").value = place;
    part("time").setAttribute("aria-valuetext", fill(words.seconds, fields));
  };

  // The factor and how the motion ends at it.
  const tell = () => {
    const { factor, label, probability, ends, reason, peak, overturning } = step();
    const share = probability === null ? "" : fill(words.probability, { share: short(100 * probability) });
    const unknown = scene.points.length ? words.probability_unknown : "";
    const told = [times(factor), label, share || unknown].filter(Boolean);
    part("chosen").textContent = told.join(" · ");
    part("factor").setAttribute("aria-valuetext", told.join(", "));
    const key = ends === "overturns" && overturning !== undefined ? "overturns_by" : ends;
    const fields = { peak: short(peak ?? 0), time: digits(overturning ?? 0, 2) };
    part("verdict").textContent = reason ?? fill(words[key], fields);
    part("verdict").className = `verdict mark ${{ rest: "good", rocks: "good", overturns: "bad" }[ends] ?? "unknown"}`;
    const last = rotation && middle(rotation, scene.columns - 1), whole = scene.end >= scene.whole - 1e-6;
    const [start, end, length] = [scene.start, scene.end, scene.whole].map((time) => digits(time, 1));
    const notes = [fill(words.stretch, { start, end, whole: length })];
    if (rotation && whole && last !== null && Math.abs(last) > 0.01) notes.push(words.still_moving);
    if (body.held) notes.push(words.held);
    if (body.outline.length < 4) notes.push(words.triangle);
    if (scene.warning) notes.push(`${scene.warning}.`);
    part("notes").textContent = notes.join(" ");
  };

  const pause = () => {
    cancelAnimationFrame(playing);
    playing = 0;
    part("play").textContent = words.play;
    part("state").setAttribute("aria-live", "polite");
    if (scene?.steps) show();
  };
  const play = () => {
    if (calm.matches) return;
    const last = scene.columns - 1, rate = last / (scene.end - scene.start);
    if (place >= last) place = 0;
    part("play").textContent = words.pause;
    part("state").setAttribute("aria-live", "off"); // a reader would not keep up
    let before;
    const frame = (now) => {
      place = Math.min(place + ((now - (before ?? now)) / 1000) * Number(part("speed").value) * rate, last);
      before = now;
      show();
      if (place >= last) pause();
      else playing = requestAnimationFrame(frame);
    };
    playing = requestAnimationFrame(frame);
  };
  const go = (where) => {
    pause();
    place = Math.max(0, Math.min(scene.columns - 1, where));
    show();
  };
  const advance = (time) => go(place + (time / (scene.end - scene.start)) * scene.columns);

  const quoted = (text) => (/^[\w@%+=:,.\/~-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  // A motion that is not on the page: the command that draws it, or the reason why there is none.
  const tellMissing = () => {
    const fields = { body: body.name, record: records[record].id, reason: scene?.reason };
    const one = body.case ? ` --case ${body.case}` : "";
    const named = `--record ${quoted(fields.record)} --block ${quoted(body.block)}${one}`;
    const command = `rockpulse plot ${quoted(data.file)} rotation-history ${named} --factor 1 -o rotation.png`;
    const [text, code] = part("missing").children;
    text.textContent = fill(scene ? words.no_motion : words.not_stored, fields);
    code.textContent = command;
    code.hidden = Boolean(scene);
  };
  const choose = () => {
    pause();
    scene = body.scenes.find((one) => one.record === record);
    const stored = Boolean(scene?.steps);
    part("missing").hidden = stored;
    part("scene").hidden = !stored;
    if (!stored) return tellMissing();
    at = Math.max(scene.steps.findIndex((one) => one.factor === 1), 0);
    part("factor").max = scene.steps.length - 1;
    part("factor").value = at;
    part("time").max = scene.columns - 1;
    place = 0;
    draw();
  };
  const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
  const group = (label, options) => {
    const made = document.createElement("optgroup");
    made.label = label;
    made.append(...options);
    return made;
  };
  const listRecords = () => {
    const named = (row) => [records[row].id, records[row].words].filter(Boolean).join(" · ");
    const here = body.scenes.map((one) => option(one.record, `${one.why.join(", ")}: ${named(one.record)}`));
    const rows = new Set(body.scenes.map((one) => one.record));
    const others = records.map((_, row) => row).filter((row) => !rows.has(row)).map((row) => option(row, named(row)));
    const groups = [[words.stored_here, here], [words.not_stored_here, others]].filter((one) => one[1].length);
    part("record").replaceChildren(...groups.map((one) => group(...one)));
    if (!rows.has(record)) record = body.scenes.length ? body.scenes[0].record : Math.max(record, 0);
    part("record").value = record;
  };
  const pick = (index) => {
    body = bodies[index];
    listRecords();
    choose();
  };

  part("body").append(...bodies.map((one, index) => option(index, one.name)));
  part("body").addEventListener("change", (event) => pick(Number(event.target.value)));
  part("record").addEventListener("change", (event) => {
    record = Number(event.target.value);
    choose();
  });
  part("factor").addEventListener("input", (event) => {
    at = Number(event.target.value);
    draw();
  });
  part("time").addEventListener("input", (event) => go(Number(event.target.value)));
  part("play").addEventListener("click", () => (playing ? pause() : play()));
  part("back").addEventListener("click", () => advance(-STEP));
  part("forward").addEventListener("click", () => advance(STEP));
  for (const name of ["ground", "rotation"]) {
    const point = (event) => {
      const box = part(name).getBoundingClientRect();
      go(((event.clientX - box.left - drawing.LEFT) / (box.width - drawing.LEFT - drawing.RIGHT)) * scene.columns);
    };
    part(name).addEventListener("pointerdown", point);
    part(name).addEventListener("pointermove", (event) => {
      if (event.buttons) point(event);
    });
  }
  const quiet = () => {
    if (calm.matches) pause();
    part("play").hidden = part("speed").parentNode.hidden = calm.matches;
    part("reduced").hidden = !calm.matches;
  };
  calm.addEventListener("change", quiet);
  root.hidden = false;
  quiet();
  pick(0);
  let width = root.clientWidth;
  new ResizeObserver(() => {
    if (root.clientWidth !== width && scene?.steps) draw();
    width = root.clientWidth;
  }).observe(root);
})();
