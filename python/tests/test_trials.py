"""Trials and episodes by Ray, with two local workers: the same results as the program's own, for any split. By `make test-python`."""
import os
import subprocess
import sys
import unittest
from pathlib import Path

import himc

# a busy machine may start slowly; nothing is asked of the network
os.environ.update({"RAY_raylet_start_wait_time_s": "600", "RAY_AUTH_MODE": "disabled", "RAY_USAGE_STATS_ENABLED": "0", "RAY_worker_niceness": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"})
try:
    import ray
except ImportError:
    print("test_trials.py: skipped: no ray (pip install ray)")
    sys.exit()

from himc import trials

ONLY = "legato,himc,computed-torque"


def episode(seed):
    """The reward of a noisy episode: a worker makes its own environment."""
    import himc.gym
    env = himc.gym.Drumming("stroke 0.6 right legato mf", motor_noise=0.01)
    observation, _ = env.reset(seed=seed)
    total, done = 0.0, False
    while not done:
        observation, reward, done, _, _ = env.step(observation["tips"][:, :3])
        total += reward
    return total


class Ray(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        found = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])  # this file, for its functions
        ray.init(num_cpus=2, object_store_memory=10**8, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": found}})

    @classmethod
    def tearDownClass(cls):
        ray.shutdown()

    def test_any_split_gives_the_program_s_table(self):
        program = Path(himc.__file__).parent / "bin" / "himc"
        own = subprocess.run([str(program), "evaluate", "--trials", "2", "--only", ONLY, "--quiet"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(own.count("\n"), 2)
        for parts in (1, 2):
            self.assertEqual(trials.evaluate(2, parts, ONLY), own)

    def test_episodes_are_those_of_one_process_in_their_order(self):
        rewards = trials.map(episode, range(3))
        self.assertEqual(rewards, [episode(seed) for seed in range(3)])
        self.assertEqual(len(set(rewards)), 3)

    def test_two_workers_share_the_work(self):
        self.assertEqual(len(set(trials.map(_worker, range(8)))), 2)

    def test_wrong_words_are_one_line(self):
        for parts, only, line in ((0, ONLY, "parts: 0, expected 1 .. 2"), (3, ONLY, "parts: 3"), (1, "legatto", "--only: legatto")):
            with self.assertRaisesRegex(himc.Error, "^(himc evaluate: )?" + line):
                trials.evaluate(2, parts, only)


def _worker(_):
    import time
    time.sleep(0.5)
    return os.getpid()


if __name__ == "__main__":
    unittest.main()
