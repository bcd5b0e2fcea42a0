// One sound at a time: starting one stops the others.
const sounds = [...document.querySelectorAll("audio")];
for (const sound of sounds) {
  sound.addEventListener("play", () => {
    for (const other of sounds) if (other !== sound) other.pause();
  });
}

// A blind comparison: one of the two plays, the listener says which, and the page counts.
const blind = document.querySelector(".blind");
if (blind && sounds.length > 1) {
  const pair = [sounds[0], sounds[sounds.length - 1]];
  const score = blind.querySelector("output");
  const [play, ...answers] = blind.querySelectorAll("button");
  let hidden = null;
  let copy = null;
  let [right, given] = [0, 0];
  const stop = () => {
    if (copy !== null) copy.pause();
    for (const sound of sounds) sound.pause();
  };
  play.addEventListener("click", () => {
    stop();
    if (hidden === null) hidden = Math.floor(Math.random() * 2);
    copy = new Audio(pair[hidden].src);
    copy.play();
  });
  answers.forEach((answer, index) => {
    answer.addEventListener("click", () => {
      if (hidden === null) return;
      stop();
      given += 1;
      if (index === hidden) right += 1;
      const truth = hidden === 0 ? "the recording" : "the fit";
      hidden = null;
      score.textContent = `That was ${truth}. ${right} of ${given} right; guesses are right half the time`;
    });
  });
}
