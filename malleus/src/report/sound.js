// One sound at a time: starting one stops the others.
const sounds = [...document.querySelectorAll("audio")];
// Sound of the blind comparison that plays, or played last.
let hiddenSound = null;
const stopAllBut = (kept) => {
  for (const sound of [...sounds, hiddenSound]) if (sound !== null && sound !== kept) sound.pause();
};
for (const sound of sounds) sound.addEventListener("play", () => stopAllBut(sound));

// A blind comparison: one of the two plays, the listener says which, and the page counts.
const blind = document.querySelector(".blind");
if (blind && sounds.length > 1) {
  const pair = [sounds[0], sounds[sounds.length - 1]];
  const score = blind.querySelector("output");
  const [play, ...answers] = blind.querySelectorAll("button");
  // Index in the pair of the sound that waits for an answer.
  let hidden = null;
  let [right, given] = [0, 0];
  // Only a sound that has been played can be answered.
  const choose = (index) => {
    hidden = index;
    for (const answer of answers) answer.disabled = hidden === null;
  };
  choose(null);
  play.addEventListener("click", () => {
    if (hidden === null) choose(Math.floor(Math.random() * 2));
    stopAllBut(null);
    hiddenSound = new Audio(pair[hidden].src);
    hiddenSound.play();
  });
  answers.forEach((answer, index) => {
    answer.addEventListener("click", () => {
      stopAllBut(null);
      given += 1;
      if (index === hidden) right += 1;
      const truth = hidden === 0 ? "the recording" : "the fit";
      choose(null);
      score.textContent = `That was ${truth}. ${right} of ${given} right; guesses are right half the time`;
    });
  });
}
