"""The environment: Gymnasium's own check, relations that a learner relies on, and the body against MuJoCo's. By `make test-python`."""
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import himc
import himc.gym

PROGRAM = Path(himc.__file__).parent / "bin" / "himc"
PIECE = "stroke 1 right legato mf; stroke 1.5 left legato f;"


def episode(env, action, seed=0):
    """The rewards' parts, summed, and all observations; `action` is a function of the environment and its observation."""
    observation, _ = env.reset(seed=seed)
    parts, seen, done = {}, [], False
    while not done:
        observation, reward, done, _, info = env.step(action(env, observation))
        assert abs(reward - sum(info["reward"].values())) < 1e-12
        for name, value in info["reward"].items():
            parts[name] = parts.get(name, 0) + value
        seen.append(np.concatenate([observation[name].ravel() for name in sorted(observation)]))
    return parts, np.array(seen)


def still(env, observation):
    return observation["tips"][:, :3]


def player(later=0.0, factor=1.0):
    """Moves the joints as himc's own performer did, so much later, or so much more slowly up and down."""
    r = himc.render(PIECE, settings=himc.gym.SETTINGS)
    rows = r.motion["rotation"][:, himc.gym.ARMS]

    def action(env, observation):
        row = rows[min(max(int(round((env.time - later) / himc.gym.STEP)) + 1, 0), len(rows) - 1)]
        return rotation_vectors(row if factor == 1 else between(rows[0], row, factor))
    return action


def rotation_vectors(q):
    q = q * np.sign(q[:, :1] + 1e-300)
    length = np.linalg.norm(q[:, 1:], axis=1, keepdims=True)
    return q[:, 1:] * 2 * np.arctan2(length, q[:, :1]) / np.maximum(length, 1e-12)


def between(a, b, share):
    """From quaternions a towards b, normalised; near enough for small turns."""
    b = b * np.sign((a * b).sum(axis=1, keepdims=True))
    q = a + share * (b - a)
    return q / np.linalg.norm(q, axis=1, keepdims=True)


class Environment(unittest.TestCase):
    def test_gymnasium_finds_nothing(self):
        for control in himc.gym.CONTROLS:
            with self.subTest(control), warnings.catch_warnings():
                warnings.simplefilter("error")
                check_env(gymnasium.make("himc/Drumming-v0", score=PIECE, control=control).unwrapped, skip_render_check=True)

    def test_who_plays_as_the_performer_is_rewarded_who_is_late_soft_or_idle_less(self):
        env = himc.gym.Drumming(PIECE, control="joints")
        alike, late, soft = (episode(env, p)[0]["strokes"] for p in (player(), player(later=0.04), player(factor=0.9)))
        idle = episode(himc.gym.Drumming(PIECE), still)[0]
        self.assertGreater(alike, 1)
        self.assertLess(late, alike)
        self.assertLess(soft, alike)
        self.assertEqual(idle["strokes"], 0)
        self.assertLess(idle["sound"], 0)

    def test_five_centimetres_aside_halve_the_worth(self):
        env, aside = (himc.gym.Drumming(PIECE, control="joints") for _ in range(2))
        aside.reference = [asked + (0, 0, himc.gym.ASIDE, 0, 0) for asked in aside.reference]
        there, beside = (episode(e, player())[0] for e in (env, aside))
        self.assertAlmostEqual(beside["strokes"] / there["strokes"], 0.5, delta=0.15)
        self.assertEqual((beside["sound"], beside["effort"]), (there["sound"], there["effort"]))

    def test_who_sounds_like_the_reference_at_each_step_loses_nothing(self):
        env, heard = himc.gym.Drumming(PIECE, control="joints"), [np.zeros(himc.gym.SAMPLES)]
        observation, _ = env.reset()
        act, done, actions = player(), False, []
        while not done:
            actions.append(act(env, observation))
            observation, _, done, _, info = env.step(actions[-1])
            heard.append(info["sound"][:, 0])
        self.assertGreater(np.abs(heard).max(), 1e-3)
        for later in (0, 1):
            env._sound = np.roll(np.concatenate(heard), later * himc.gym.SAMPLES)
            env.reset()
            lost = sum(env.step(action)[4]["reward"]["sound"] for action in actions)
            self.assertTrue(lost < -1e-3 if later else lost == 0, lost)

    def test_the_strokes_to_come_are_observed(self):
        env = himc.gym.Drumming(PIECE)
        left, right = env.reset()[0]["strokes"]
        self.assertEqual((left[0, 0], right[0, 0], left[1].any(), right[1].any()), (1, 1, False, False))  # one of each hand
        self.assertAlmostEqual(right[0, 1] + himc.gym.STEP, 0.6, delta=0.01)  # beat 1 at 100 BPM
        self.assertAlmostEqual(left[0, 1] - right[0, 1], 0.3, delta=0.01)
        self.assertGreater(left[0, 5], right[0, 5])  # f, mf
        self.assertGreater(left[0, 3], right[0, 3])
        observation, after = env.step(still(env, env.reset()[0]))[0], right.copy()
        after[0, 1] -= himc.gym.STEP
        np.testing.assert_allclose(observation["strokes"][1], after, atol=1e-9)
        for _ in range(190):  # until the right hand's is lost, the left one's is not
            observation = env.step(still(env, observation))[0]
        self.assertFalse(observation["strokes"][1].any())
        self.assertEqual(observation["strokes"][0, 0, 0], 1)

    def test_a_score_that_is_written_again_is_read_again(self):
        with tempfile.TemporaryDirectory() as folder:
            score, times = Path(folder) / "score.txt", []
            for beat in (1, 2):
                score.write_text(f"stroke {beat} right legato mf;")
                times.append(himc.gym.Drumming(str(score)).reference[1][0, 0])
        self.assertAlmostEqual(times[1] - times[0], 0.6, delta=0.01)

    def test_a_seed_gives_the_same_bits_another_one_other_noise(self):
        env = himc.gym.Drumming(PIECE, motor_noise=0.01)
        first, again, other = (episode(env, still, seed)[1] for seed in (1, 1, 2))
        np.testing.assert_array_equal(first, again)
        self.assertFalse(len(first) == len(other) and (first == other).all())

    def test_restore_is_exact_also_in_another_environment(self):
        env, fresh = (himc.gym.Drumming(PIECE, motor_noise=0.01) for _ in range(2))
        observation, _ = env.reset(seed=3)
        for _ in range(60):
            observation = env.step(still(env, observation))[0]
        kept = env.snapshot()
        after = [env.step(still(env, observation)) for _ in range(20)]
        for e in (env, fresh):
            restored = e.restore(kept)
            for name in observation:
                np.testing.assert_array_equal(restored[name], observation[name])
            for one in after:
                step = e.step(still(e, restored))
                self.assertEqual(step[1], one[1])
                np.testing.assert_array_equal(step[4]["sound"], one[4]["sound"])

    def test_environments_run_side_by_side(self):
        envs = gymnasium.make_vec("himc/Drumming-v0", num_envs=2, vectorization_mode="async", score=PIECE)
        observation, _ = envs.reset(seed=[1, 1])
        for _ in range(5):
            observation = envs.step(observation["tips"][:, :, :3].astype(np.float32))[0]
        for values in observation.values():
            np.testing.assert_array_equal(values[0], values[1])
        envs.close()

    def test_what_is_no_score_control_or_action_is_refused_in_one_line(self):
        with self.assertRaisesRegex(himc.Error, "^control: 'tip', expected tips joints torques$"):
            himc.gym.Drumming(PIECE, control="tip")
        with self.assertRaisesRegex(himc.Error, "^score: has no stroke that is played, expected one or more$"):
            himc.gym.Drumming("tempo 90;")
        with self.assertRaisesRegex(himc.Error, "^motor_noise: -1, expected 0 or more$"):
            himc.gym.Drumming(PIECE, motor_noise=-1)
        for score, settings in (("rate task 1000;" + PIECE, ()), (PIECE, ("rate task 1000",))):
            with self.assertRaisesRegex(himc.Error, "^rate task 1000: expected 250, the environment's steps in a second$"):
                himc.gym.Drumming(score, settings=settings)
        env = himc.gym.Drumming(PIECE)
        env.reset()
        with self.assertRaisesRegex(himc.Error, r"^action: of shape \(2, 3\), expected finite numbers of shape \(2, 3\)$"):
            env.step(np.full((2, 3), np.nan))

    def test_the_body_falls_as_in_mujoco(self):
        try:
            import mujoco
        except ImportError:
            self.skipTest("no mujoco")
        model = mujoco.MjModel.from_xml_string(subprocess.run(
            [str(PROGRAM), "export", "-o", "-", "--quiet"], capture_output=True, text=True, check=True).stdout)
        model.opt.timestep = 1e-4
        p = himc.Performance(channels=0, task=250)
        p.add_drum()
        p.drum_command("kettle", "place 4 0 0.8")  # out of the sticks' way
        p.process(0.004)
        p.drive(torques=np.zeros((19, 3)))
        p.process(1 / 48000)  # the row at 4 ms
        start = p.motion[-1]
        data = mujoco.MjData(model)
        ids = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in himc.joint_names]
        for j, i in enumerate(ids):
            at = model.jnt_qposadr[i]
            data.qpos[at:at + 4] = start["rotation"][j]
        worst = 0.0
        for _ in range(50):  # 0.2 s: arms and trunk swing down as pendulums
            p.process(0.004)
            for _ in range(40):
                mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            row = p.motion[-1]
            for i, name in enumerate(himc.segment_names):
                body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
                worst = max(worst, np.abs(data.xpos[body] - row["segment"][i]).max())
        self.assertGreater(np.abs(row["segment"] - start["segment"]).max(), 0.1)
        self.assertLess(worst, 1e-3)


class Example(unittest.TestCase):
    def test_a_few_generations_learn(self):
        sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples"))
        import learn_stroke
        _, curve = learn_stroke.learn(map, say=lambda line: None, generations=3)
        self.assertGreater(curve[-1, 1], curve[0, 0] + 0.05)


if __name__ == "__main__":
    unittest.main()
