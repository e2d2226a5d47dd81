"""Learns one stroke on a beat from its reward alone: the cross-entropy method (Rubinstein 1999) over what elbow and wrist do.

    python learn_stroke.py [curve.png]

Nothing tells it when, where, how high or how fast. Its eight numbers say how elbow and wrist go up, down and back, and how the shoulder
turns meanwhile. Two minutes on two cores to .95 of 1; the curve shows the reward of each generation's elite and of the best so far.
"""
import multiprocessing
import sys

import numpy as np

import himc
import himc.gym

SCORE = "tempo 100; stroke 0 right legato mf"
# elbow up, wrist up, elbow down, wrist down, two turns of the shoulder (rad), when the way down begins and how long it lasts (s)
GUESS = np.array([0.2, 0.3, 0.1, 0.2, 0.0, 0.0, 0.3, 0.1])
SPREAD = np.array([0.2, 0.3, 0.1, 0.2, 0.15, 0.15, 0.1, 0.05])
ROWS = [list(himc.gym.ARMS).index(himc.joint_names.index(name)) for name in ("right-elbow", "right-wrist", "right-shoulder")]
PEOPLE, ELITE, GENERATIONS = 32, 6, 16


def turned(q, v):
    """Rotation vectors (n, 3) of joints with unit quaternions q (n, 4), turned by rotation vectors v (n, 3) in their own axes."""
    half = np.linalg.norm(v, axis=1, keepdims=True) / 2
    w, v = np.cos(half), v * np.sinc(half / np.pi) / 2
    w, v = (q[:, :1] * w - (q[:, 1:] * v).sum(axis=1, keepdims=True), q[:, :1] * v + w * q[:, 1:] + np.cross(q[:, 1:], v))
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return v * 2 * np.arctan2(length, w) / np.maximum(length, 1e-12)


def play(numbers):
    """The reward of an episode."""
    begins, lasts = np.clip(numbers[6:], 0.02, 0.4)
    times = np.cumsum([0, begins / 2, begins / 2, lasts, 0.1])
    env = himc.gym.Drumming(SCORE, control="joints")
    observation, _ = env.reset(seed=0)
    rest, total, done = observation["joints"][himc.gym.ARMS], 0.0, False
    turn = np.zeros((len(rest), 3))
    while not done:
        for row, up, down in zip(ROWS, numbers[:2], numbers[2:4]):
            turn[row, 1] = np.interp(env.time, times, [0, -up, -up, down, 0])
        turn[ROWS[2], ::2] = numbers[4:6] * np.interp(env.time, times, [0, 1, 1, 1, 0])
        _, reward, done, _, _ = env.step(turned(rest, turn))
        total += reward
    return total


def learn(people, say=print, generations=GENERATIONS):
    """The best numbers, and of each generation the reward of its elite and of the best so far."""
    chance = np.random.default_rng(0)
    mean, spread, curve, best = GUESS, SPREAD, [], (-np.inf, None)
    for generation in range(generations):
        tries = mean + spread * chance.standard_normal((PEOPLE, len(mean)))
        rewards = np.array(list(people(play, tries)))
        elite = tries[np.argsort(rewards)[-ELITE:]]
        mean, spread = elite.mean(axis=0), elite.std(axis=0) + 0.05 * SPREAD
        best = max(best, (rewards.max(), tuple(tries[rewards.argmax()])))
        curve.append((np.sort(rewards)[-ELITE:].mean(), best[0]))
        say(f"generation {generation + 1}: elite {curve[-1][0]:.3f}, best {best[0]:.3f}")
    return np.array(best[1]), np.array(curve)


def main():
    with multiprocessing.get_context("fork").Pool() as people:
        numbers, curve = learn(people.map)
    print("up, down and turned (rad), begins and lasts (s):", *np.round(numbers, 3))
    if len(sys.argv) > 1:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        pyplot.plot(np.arange(1, len(curve) + 1), curve, label=["elite", "best so far"])
        pyplot.gca().set(xlabel="generation", ylabel="reward of a stroke (1 at most)", title="A stroke learned")
        pyplot.legend()
        pyplot.savefig(sys.argv[1])


if __name__ == "__main__":
    main()
