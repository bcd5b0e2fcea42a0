// MUSHRA: each trial's sounds are rated from 0 to 100, blind and in random order.
const study = JSON.parse(document.getElementById("data").textContent);
const place = document.getElementById("study");
const storageKey = `malleus-study-${study.name}`;
const words = ["bad", "poor", "fair", "good", "excellent"];

const shuffled = (count) => {
  const order = [...Array(count).keys()];
  for (let last = count - 1; last > 0; last -= 1) {
    const other = Math.floor(Math.random() * (last + 1));
    [order[last], order[other]] = [order[other], order[last]];
  }
  return order;
};

// What a listener has done so far; a page that is loaded again goes on with it.
const begun = () => ({
  listener: Math.random().toString(36).slice(2, 10),
  order: shuffled(study.trials.length),
  sounds: study.trials.map((trial) => shuffled(trial.sounds.length)),
  at: 0,
  ratings: [],
});
const loaded = () => {
  try {
    const kept = JSON.parse(localStorage.getItem(storageKey));
    return kept !== null && kept.order.length === study.trials.length ? kept : begun();
  } catch {
    return begun();
  }
};
let state = loaded();
const keep = () => {
  try {
    localStorage.setItem(storageKey, JSON.stringify(state));
  } catch {
    // A browser that keeps nothing still lets the ratings be saved at the end.
  }
};

let playing = null;
const stop = () => {
  if (playing !== null) playing.pause();
  playing = null;
};

const element = (tag, properties, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

const csv = () => {
  const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;
  const lines = state.ratings.map((r) =>
    [r.listener, r.trial, quoted(study.trials[r.trial].text), r.method, r.rating, r.order, r.plays].join(","),
  );
  return ["listener,trial,text,method,rating,order,plays", ...lines].join("\n") + "\n";
};

const showEnd = () => {
  const save = element("button", { textContent: "Save the ratings" });
  save.addEventListener("click", () => {
    const file = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
    const link = element("a", { href: file, download: `${study.name}-${state.listener}.csv` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(file), 1000);
  });
  const again = element("button", { textContent: "Begin anew" });
  again.addEventListener("click", () => {
    state = begun();
    keep();
    show();
  });
  const done = `${state.ratings.length} ratings of ${state.at} trials.`;
  place.replaceChildren(element("h2", { textContent: "Thank you" }), element("p", { textContent: done }), save, " ", again);
};

const show = () => {
  stop();
  if (state.at >= state.order.length) {
    showEnd();
    return;
  }
  const number = state.order[state.at];
  const trial = study.trials[number];
  const order = state.sounds[number];
  const plays = order.map(() => 0);
  const isRated = order.map(() => false);
  const next = element("button", { textContent: "Next", disabled: true });
  const check = () => {
    next.disabled = !isRated.every(Boolean);
  };
  const rows = order.map((sound, index) => {
    const letter = String.fromCharCode(65 + index);
    const play = element("button", { textContent: `Play ${letter}` });
    const rating = element("input", { type: "range", min: 0, max: 100, value: 50, disabled: true });
    rating.setAttribute("aria-label", `Rating of ${letter}`);
    const shown = element("output", { textContent: "play first" });
    play.addEventListener("click", () => {
      stop();
      playing = new Audio(trial.sounds[sound]);
      playing.play();
      plays[index] += 1;
      rating.disabled = false;
      if (!isRated[index]) shown.textContent = "not rated";
    });
    const rate = () => {
      isRated[index] = true;
      shown.textContent = `${rating.value}, ${words[Math.min(4, Math.floor(rating.value / 20))]}`;
      check();
    };
    rating.addEventListener("input", rate);
    rating.addEventListener("change", rate);
    return { rating, row: element("div", { className: "rating" }, play, rating, shown) };
  });
  next.addEventListener("click", () => {
    order.forEach((sound, index) => {
      state.ratings.push({
        listener: state.listener,
        trial: number,
        method: trial.methods[sound],
        rating: Number(rows[index].rating.value),
        order: index,
        plays: plays[index],
      });
    });
    state.at += 1;
    keep();
    show();
  });
  const stopButton = element("button", { textContent: "Stop" });
  stopButton.addEventListener("click", stop);
  place.replaceChildren(
    element("h2", { textContent: `${state.at + 1} of ${state.order.length}` }),
    element("p", { className: "described", textContent: trial.text }),
    element("p", { className: "muted", textContent: `0 to 100: ${words.join(", ")}` }),
    ...rows.map(({ row }) => row),
    element("p", {}, stopButton, " ", next),
  );
};
show();
