// Plays the outlines of the objects of a report, frame by frame. It needs nothing but the page.
"use strict";
(() => {
  // A line is [closed, x, y, step x, step y, ...].
  const pointsOf = (line) => {
    const points = [];
    let x = 0, y = 0;
    for (let k = 1; k + 1 < line.length; k += 2) {
      x += line[k];
      y += line[k + 1];
      points.push([x, y]);
    }
    return points;
  };
  const place = (m, [x, y]) => {
    const w = m.length === 9 ? m[6] * x + m[7] * y + m[8] : 1;
    return [(m[0] * x + m[1] * y + m[2]) / w, (m[3] * x + m[4] * y + m[5]) / w];
  };
  const at = ([x, y]) => `${Math.round(x)} ${Math.round(y)}`;
  const dots = (points) => points.map((p) => `M${at(p)}h0`).join("");

  // The parts of a known outline that a frame shows, and those that it does not.
  const parts = (lines, map, hidden) => {
    const paths = { known: "", hidden: "" };
    const isHidden = new Set();
    for (const [first, count] of hidden) for (let k = 0; k < count; k++) isHidden.add(first + k);
    let number = 0;
    for (const line of lines) {
      const points = pointsOf(line).map((p) => place(map, p));
      const steps = line[0] ? points.length : points.length - 1;
      let last = "";
      for (let k = 0; k < steps; k++) {
        const next = (k + 1) % points.length;
        const kind = isHidden.has(number + k) || isHidden.has(number + next) ? "hidden" : "known";
        paths[kind] += (kind === last ? "" : `M${at(points[k])}`) + `L${at(points[next])}`;
        last = kind;
      }
      number += points.length;
    }
    return paths;
  };

  const start = (player) => {
    const data = JSON.parse(player.querySelector('script[type="application/json"]').textContent);
    const { frames, known, size } = data;
    const [stage, marks] = [".stage", ".marks"].map((name) => player.querySelector(name));
    const path = (name) => stage.querySelector("." + name);
    const [play, slider, zoom] = [".play", "input", ".zoom"].map((name) => player.querySelector(name));
    const now = player.querySelector(".now");
    const cells = [...player.querySelectorAll(".values tr")].slice(1).map((row) => row.cells);
    let shown = 0, timer = 0, isClose = false;

    // The way of the middle up to a frame, broken where it is not known and where the object was begun anew.
    const way = (last) => {
      let d = "", before = null;
      frames.slice(0, last + 1).forEach((frame) => {
        if (frame.middle) {
          const follows = before && before.middle && before.segment === frame.segment;
          d += (follows ? "L" : "M") + at(frame.middle) + (follows ? "" : "h0");
        }
        before = frame;
      });
      return d;
    };
    const boxes = frames.map((frame) => {
      const points = frame.points.flatMap(pointsOf);
      if (!points.length) return null;
      const range = (k) => [Math.min(...points.map((p) => p[k])), Math.max(...points.map((p) => p[k]))];
      return [range(0), range(1)];
    });
    const extents = boxes.filter(Boolean).map(([x, y]) => Math.max(x[1] - x[0], y[1] - y[0])).sort((a, b) => a - b);
    const usual = (extents[Math.floor(extents.length / 2)] || size[0]) * 1.6;
    const look = () => {
      let box = [0, 0, size[0], size[1]];
      const around = boxes[shown] || boxes.slice(0, shown).reverse().find(Boolean);
      if (isClose && around) {
        const [x, y] = around.map(([low, high]) => (low + high) / 2);
        const width = (usual * size[0]) / Math.min(size[0], size[1]), height = (usual * size[1]) / Math.min(size[0], size[1]);
        box = [x - width / 2, y - height / 2, width, height];
      }
      stage.setAttribute("viewBox", box.map(Math.round).join(" "));
    };

    const show = (index) => {
      shown = Math.max(0, Math.min(frames.length - 1, index));
      const frame = frames[shown];
      const isRejected = frame.rejected !== undefined;
      path("points").setAttribute("d", dots(frame.points.flatMap(pointsOf)));
      path("points").classList.toggle("rejected", isRejected);
      const lines = frame.known ? parts(known[frame.known[0]], frame.known[1], frame.hidden) : { known: "", hidden: "" };
      path("known").setAttribute("d", isRejected ? "" : lines.known);
      path("hidden").setAttribute("d", isRejected ? lines.known : lines.hidden);
      path("travelled").setAttribute("d", way(shown));
      path("middle").setAttribute("d", frame.middle ? dots([frame.middle]) : "");
      const time = frame.time === undefined ? "" : `, ${Number(frame.time.toPrecision(5))} s`;
      const phase = frame.phase ? `, ${frame.phase}` : "";
      const fate = isRejected ? `not used: ${frame.rejected}` : "used";
      const text = `Frame ${frame.frame}${time}${phase}, ${fate}`;
      now.textContent = text;
      now.classList.toggle("rejected", isRejected);
      slider.value = shown;
      slider.setAttribute("aria-valuetext", text);
      cells.forEach((row, k) => {
        const [value, deviation] = frame.values[k] || ["", ""];
        row[1].textContent = value || "not stated";
        row[2].textContent = deviation;
      });
      look();
    };

    // In its own time where that takes 3 to 60 seconds, else faster or slower.
    const times = frames.map((frame) => frame.time).filter((time) => time !== undefined);
    const span = times.length > 1 ? times[times.length - 1] - times[0] : 0;
    const pace = span > 0 ? span / Math.max(3, Math.min(60, span)) : 0;
    const wait = (index) => {
      const [a, b] = [frames[index].time, frames[index + 1].time];
      return pace > 0 && a !== undefined && b !== undefined ? (1000 * (b - a)) / pace : (1000 * 8) / frames.length;
    };
    const stop = () => {
      clearTimeout(timer);
      timer = 0;
      play.textContent = "Play";
    };
    const step = () => {
      let index = shown, pause = 0;
      while (index < frames.length - 1 && pause < 16) pause += Math.max(1, wait(index++));
      if (index === shown) return stop();
      timer = setTimeout(() => {
        show(index);
        step();
      }, Math.min(pause, 2000));
    };
    const toggle = () => {
      if (timer) return stop();
      if (shown === frames.length - 1) show(0);
      play.textContent = "Pause";
      step();
    };
    const go = (index) => {
      stop();
      show(index);
    };

    play.addEventListener("click", toggle);
    zoom.addEventListener("click", () => {
      isClose = !isClose;
      zoom.setAttribute("aria-pressed", isClose);
      look();
    });
    slider.addEventListener("input", () => go(Number(slider.value)));
    stage.addEventListener("click", () => slider.focus());
    player.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.key === " " && event.target.tagName === "BUTTON") return;
      const act = {
        ArrowLeft: () => go(shown - 1),
        ArrowRight: () => go(shown + 1),
        Home: () => go(0),
        End: () => go(frames.length - 1),
        " ": toggle,
      }[event.key];
      if (act) {
        event.preventDefault();
        act();
      }
    });

    path("way").setAttribute("d", way(frames.length - 1));
    const rejected = frames.flatMap((frame, k) => (frame.rejected === undefined ? [] : [k]));
    marks.querySelector("path").setAttribute("d", rejected.map((k) => `M${k} 0v1`).join(""));
    player.classList.add("ready");
    show(0);
  };

  document.querySelectorAll(".player").forEach(start);
})();
