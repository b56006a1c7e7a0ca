// SPDX-License-Identifier: Apache-2.0
/** Starts or stops a player, which has a button `play` and a `tick(time)` for each frame while `playing`. */
export function setPlaying(player, playing) {
  if (playing === Boolean(player.playing)) return;
  player.playing = playing;
  player.play.textContent = playing ? 'Pause' : 'Play';
  player.play.setAttribute('aria-pressed', String(playing));
  player.last = undefined;
  if (playing) requestAnimationFrame((time) => player.tick(time));
}
