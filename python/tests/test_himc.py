"""The package against the program, and the examples of the documentation. Run from the repository's root by `make test-python`."""
import json
import re
import subprocess
import tempfile
import time
import unittest
from importlib import metadata
from pathlib import Path

import numpy as np

import himc

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(himc.__file__).parent / "bin" / "himc"
CAPTURE = ROOT.parent / "shared/mocap/drumstroke_pearl_240hz/stroke.trc"
PIECE = "stroke 1 right accent f; stroke 2 left tenuto mf;"
XYLOPHONE = "instrument x xylophone; stroke 1 right accent f; stroke 2 left tenuto mf C5 x;"


def samples(path, channels=2):
    """The floats behind the header of a WAV file."""
    data = Path(path).read_bytes()
    at = data.index(b"data")
    return np.frombuffer(data[at + 8:], np.float32).reshape(-1, channels)


class Package(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = Path(self.folder.name)
        (self.at / "piece.txt").write_text(PIECE)

    def tearDown(self):
        self.folder.cleanup()

    def program(self, *arguments):
        return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, check=True, cwd=self.at)

    def test_a_rendering_has_the_bits_of_the_program(self):
        self.program("render", "piece.txt", "-o", "a.wav", "--motion", "a.npz", "--columns", "all", "--quiet")
        r, file = himc.render(self.at / "piece.txt"), np.load(self.at / "a.npz")
        np.testing.assert_array_equal(r.sound, samples(self.at / "a.wav"))
        np.testing.assert_array_equal(r.motion["torque"], file["torques_n_m"])
        np.testing.assert_array_equal(r.motion["energy"]["joint"], file["work_j"])
        np.testing.assert_array_equal(r.motion["orientation"], file["orientations"])
        self.assertEqual(r.stats["played"], 2)
        self.assertEqual([s.decode() for s in r.strikes["nuance"]], ["accent", "tenuto"])

    def test_an_instrument_of_a_score_stands_alone_as_in_the_program(self):
        (self.at / "bars.txt").write_text(XYLOPHONE)
        self.program("render", "bars.txt", "-o", "a.wav", "--quiet")
        r = himc.render(self.at / "bars.txt")
        np.testing.assert_array_equal(r.sound, samples(self.at / "a.wav"))
        self.assertEqual(set(r.strikes["drum"]), {b"x"})

    def test_settings_and_channels_are_those_of_the_program(self):
        self.program("render", "piece.txt", "-o", "a.wav", "--law", "printed", "--channels", "1", "--quiet")
        r = himc.render(PIECE, channels=1, motion=False, settings=["law printed"])
        np.testing.assert_array_equal(r.sound, samples(self.at / "a.wav", 1))
        self.assertEqual(len(r.motion), 0)

    def test_opensim_reads_the_same_rows(self):
        try:
            import opensim
        except ImportError:
            self.skipTest("no opensim")
        for name in ("a.mot", "a.csv"):
            self.program("render", "piece.txt", "-o", "a.wav", "--motion", name, "--columns", "torques,root", "--quiet")
        table = opensim.TimeSeriesTable(str(self.at / "a.mot"))
        rows = np.genfromtxt(self.at / "a.csv", delimiter=",", names=True, deletechars="")
        self.assertEqual(list(table.getColumnLabels()), list(rows.dtype.names[1:]))
        np.testing.assert_array_equal(np.array(table.getIndependentColumn()), rows["time_s"])
        np.testing.assert_array_equal(table.getMatrix().to_numpy(), np.array(rows.tolist())[:, 1:])

    def test_a_c3d_has_places_as_points_and_forces_as_analog_channels(self):
        try:
            import ezc3d
        except ImportError:
            self.skipTest("no ezc3d")
        for name in ("a.c3d", "a.csv"):
            self.program("render", "piece.txt", "-o", "a.wav", "--motion", name, "--columns", "tips,forces,contact,root", "--quiet")
        file, rows = ezc3d.c3d(str(self.at / "a.c3d")), np.genfromtxt(self.at / "a.csv", delimiter=",", names=True, deletechars="")
        point, analog = file["parameters"]["POINT"], file["parameters"]["ANALOG"]
        self.assertEqual(point["LABELS"]["value"], ["left_tip", "right_tip", "root_center"])
        self.assertEqual([point["UNITS"]["value"], list(point["RATE"]["value"]), list(analog["RATE"]["value"])], [["mm"], [250], [250]])
        units = {"N": "_n", "N m": "_n_m", "N s": "_n_s", "J": "_j", "1": ""}
        names = [label + units[unit] for label, unit in zip(analog["LABELS"]["value"], analog["UNITS"]["value"])]
        self.assertEqual(sorted(names), sorted(n for n in rows.dtype.names[1:] if not n.endswith("_m") or n.endswith("_n_m")))
        for name, values in zip(names, file["data"]["analogs"][0]):
            np.testing.assert_allclose(values, rows[name], rtol=1e-6, atol=6e-5)  # a CSV has four digits
        self.assertGreater(rows["left_force_n"].max() + rows["right_force_n"].max(), 10)
        for k, label in enumerate(point["LABELS"]["value"]):
            for axis in range(3):
                theirs, own = file["data"]["points"][axis, k], 1000 * rows[f"{label}_{'xyz'[axis]}_m"]
                np.testing.assert_allclose(theirs[np.isfinite(own)], own[np.isfinite(own)], rtol=1e-6, atol=1e-4)

    def test_one_command_is_a_score(self):
        r = himc.render("stroke 1 right accent f")
        self.assertEqual(r.stats["played"], 1)
        with self.assertRaisesRegex(himc.Error, "^score:1: stroke: HAND: rigt, expected left right foot$"):
            himc.render("stroke 1 rigt accent f")
        for name in ("my piece.txt", "my " + "a" * 300, "my a\0b"):
            with self.assertRaises(himc.Error) as caught:
                himc.render(name)
            self.assertRegex(str(caught.exception), "cannot be read|zero byte")

    def test_a_file_is_a_file_whatever_its_name(self):
        for name in ("a;b.txt", "stroke 1 right accent f", "tempo;"):
            (self.at / name).write_text(PIECE)
            self.assertEqual(himc.render(self.at / name).stats["played"], 2, name)

    def test_motion_is_the_librarys_memory(self):
        r = himc.render(PIECE)
        self.assertFalse(r.motion.flags.owndata)
        self.assertFalse(r.motion.flags.writeable)
        tips = r.motion["tip"]
        del r  # the arrays keep their memory
        self.assertTrue(np.isfinite(tips).all())

    def test_a_rendering_is_read_only_and_equals_itself(self):
        r = himc.render("stroke 0 left legato mf;")
        self.assertFalse(r.sound.flags.writeable or r.motion.flags.writeable or r.strikes.flags.writeable)
        self.assertEqual(r, r)

    def test_info_and_dump_are_answered(self):
        p = himc.Performance()
        p.add_drum("kettle")
        self.assertIn("57 degrees of freedom", p.command("info")[0])
        self.assertIn("tempo 100", p.command("dump"))
        self.assertTrue(p.drum_command("kettle", "info")[0].startswith("kettle: radius"))
        self.assertIn("mallet medium", p.drum_command("kettle", "dump"))
        self.assertEqual(p.command("tempo 90"), [])

    def test_done_is_undone_by_what_plays_alone(self):
        def wait():
            for _ in range(50):
                if p.done:
                    break
                p.process(0.1)
            self.assertTrue(p.done)
            return len(p.strikes)
        p = himc.Performance(motion=False)
        p.add_drum()
        p.command("stroke 1 right legato mf")
        p.command("play")
        self.assertFalse(p.done)
        self.assertEqual(wait(), 1)
        for text in ("info", "dump", "tempo 90", "human 0.3", "loop 0", "latency 200", "at 5 kettle tune A2"):
            p.command(text)
            self.assertTrue(p.done, text)
        with self.assertRaises(himc.Error):
            p.command("stroke 2 both legato mf")
        self.assertTrue(p.done)
        p.command("stroke 4 left legato mf")  # the score goes on
        self.assertFalse(p.done)
        self.assertEqual(wait(), 2)
        p.command("play")
        self.assertFalse(p.done)
        self.assertEqual(wait(), 4)

    def test_strokes_are_struck_or_missed(self):
        p = himc.Performance(motion=False)
        for drum, place in (("near", "0.5 -0.2 0.8"), ("far", "0.5 1 0.8")):
            p.add_drum(drum)
            p.drum_command(drum, "place " + place)
        beats = 1 + 0.08 * np.arange(8)  # faster than an arm goes there and back
        for i, beat in enumerate(beats):
            p.command(f"stroke {beat} right accent f {('near', 'far')[i % 2]}")
        p.command("play")
        p.process(3)
        missed = p.missed
        self.assertTrue(0 < len(missed) < len(beats))
        self.assertEqual(len(missed), p.stats["missed"])
        np.testing.assert_allclose(np.sort(np.r_[p.strikes["beat"], missed["beat"]]), beats, atol=1e-6)
        np.testing.assert_allclose(missed["time"], 0.6 * missed["beat"], atol=0.005)  # at 100 BPM
        self.assertEqual(set(missed["hand"]), {1})
        p.command("reset")
        self.assertEqual(len(p.missed), 0)

    def test_the_energy_balance_closes(self):
        e = himc.render(PIECE).motion["energy"]
        held = e["kinetic"] + e["potential"]
        given = e["joint"].sum(1) + e["contact"].sum(1) + e["push"] + e["placed"] + e["numerical"]
        done = np.abs(np.diff(e["joint"], axis=0)).sum()
        self.assertLess(np.max(np.abs(held - held[0] - given + given[0])), 1e-9 * done)

    def test_live_targets_move_a_tip_step_by_step(self):
        p = himc.Performance()
        p.add_drum()
        out = np.empty((48, 2), np.float32)
        for i in range(1500):  # 1 ms each
            p.target("right", (0.45, -0.1 + 1e-4 * min(i, 1000), 1.1))
            self.assertIs(p.process(0, out), out)
        tip = p.motion["tip"][-1, 1]
        np.testing.assert_allclose(tip, (0.45, 0.0, 1.1), atol=1e-3)
        self.assertAlmostEqual(p.time, 1.5)

    def test_a_target_is_a_hand_and_three_finite_numbers(self):
        p = himc.Performance()
        p.add_drum()
        p.process(0.1)
        before = p.motion["target"][-1]
        for hand in (2, -1, 99, 2**40, "both", None, 0.5):
            with self.assertRaisesRegex(himc.Error, "hand: .*, expected"):
                p.target(hand, (0.45, 0, 1))
        for xyz in ([float("nan"), 0, 1], [0, float("inf"), 1], [0, None, 1], [0, "a", 1]):
            with self.assertRaisesRegex(himc.Error, "target: .*, expected a finite number"):
                p.target("right", xyz)
        for xyz in ([], [1, 2], [1, 2, 3, 4], 1, "xyz", [[1, 2, 3]]):
            with self.assertRaisesRegex(himc.Error, "target: .*, expected three numbers"):
                p.target("right", xyz)
        p.process(0.02)
        np.testing.assert_allclose(p.motion["target"][-1], before, atol=1e-3)

    def test_sound_goes_only_where_it_fits(self):
        p = himc.Performance()
        p.add_drum()
        frozen = np.zeros((64, 2), np.float32)
        frozen.flags.writeable = False
        (self.at / "map").write_bytes(bytes(512))
        constant = bytes(512)
        refused = {
            "read-only": [frozen, np.frombuffer(constant, np.float32).reshape(-1, 2),
                          np.memmap(self.at / "map", np.float32, "r", shape=(64, 2)), np.broadcast_to(np.float32(0), (64, 2))],
            "unaligned": [np.frombuffer(bytearray(513), np.uint8)[1:].view(np.float32).reshape(-1, 2)],
            "not in C order": [np.zeros((2, 64), np.float32).T, np.zeros((64, 4), np.float32)[:, ::2]],
            "of shape": [np.zeros((64, 1), np.float32), np.zeros(128, np.float32), np.zeros((64, 2)), np.zeros((64, 2), ">f4"),
                         np.zeros((0, 3), np.float32)],
            "list, |bytes, ": [[[0.0, 0.0]], constant],
        }
        for why, arrays in refused.items():
            for out in arrays:
                with self.assertRaisesRegex(himc.Error, f"out: .*({why}).*expected a writeable float32 array"):
                    p.process(0, out)
        self.assertEqual(p.time, 0)
        self.assertEqual(constant, bytes(512))
        # a part of an array: what is beside it stays
        whole = np.full((300, 2), 7, np.float32)
        p.drum_command("kettle", "strike 0.25 0 1")
        self.assertTrue(p.process(0, whole[100:200]).any())
        self.assertTrue((whole[:100] == 7).all() and (whole[200:] == 7).all() and (whole[100:200] != 7).all())

    def test_settings_that_are_no_numbers_are_refused(self):
        nan, p = float("nan"), himc.Performance()
        for call in (lambda: p.process(nan), lambda: p.process(-1), lambda: p.add_drum("a", nan), lambda: p.add_drum("a", -1),
                     lambda: himc.Performance(rate=nan), lambda: himc.Performance(rate="48000"), lambda: himc.Performance(rate=None), lambda: himc.Performance(physics=nan), lambda: himc.Performance(task=-1),
                     lambda: himc.Performance(channels=9), lambda: himc.Performance(channels=-1),
                     lambda: himc.render(PIECE, channels=0), lambda: p.take_options(up="x"),
                     lambda: p.take_options(left_tip="a" * 64), lambda: p.command("tempo 90\0"), lambda: p.add_drum("a\0b")):
            with self.assertRaises(himc.Error):
                call()
        self.assertEqual(p.process(0.01).shape, (480, 2))

    def test_a_reset_plays_again_from_0(self):
        p = himc.Performance()
        p.add_drum()
        played = []
        for turn in range(2):
            for text in ("stroke 1 right accent f", "play"):
                p.command(text)
            sound = p.process(2.0)
            self.assertAlmostEqual(p.time, 2.0)
            played.append((len(p.motion), [s["time"] for s in p.strikes], np.abs(sound).max()))
            self.assertEqual(len(p.strikes), 1)
            p.command("reset")
            self.assertEqual((p.time, len(p.motion), len(p.strikes), p.done), (0, 0, 0, False))
        self.assertLessEqual(abs(played[0][0] - played[1][0]), 1)
        np.testing.assert_allclose(played[0][1], played[1][1], atol=1e-3)
        p.command("tempo 90")  # another command leaves time alone
        p.process(0.5)
        p.command("tempo 120")
        self.assertAlmostEqual(p.time, 0.5)

    def test_a_reset_leaves_what_a_new_performance_has(self):
        p, new = himc.Performance(), himc.Performance()
        p.add_drum()
        new.add_drum()
        p.command("tempo 90")
        p.command("reset")
        self.assertEqual(p.command("dump"), new.command("dump"))
        p.drum_command("kettle", "strike 0.1 0.1 3")
        self.assertGreater(p.process(0.2)[:, 1].std(), 0)

    def test_a_recording_is_there_when_render_returns(self):
        with tempfile.TemporaryDirectory() as folder:
            path = folder + "/x.bvh"
            rendering = himc.render("stroke 0 left legato mf;", settings=["record " + path])
            self.assertGreater(len(himc.Take(path).points), 100)
            del rendering

    def test_licences_are_in_the_package(self):
        package = metadata.distribution("himc")
        terms = {f.name: f.read_text() for f in package.files if "licenses" in str(f)}
        self.assertEqual(package.metadata["License-Expression"], "BSD-3-Clause")
        self.assertIn("Russell L. Smith", terms["LIBRARIES.txt"])
        self.assertIn("himc contributors", terms["LICENSE"])

    def test_the_module_shows_its_own_names(self):
        self.assertEqual({name for name in dir(himc) if not name.startswith("_")}, set(himc.__all__))

    def test_displacements_that_nobody_reads_are_not_computed(self):
        player = himc.Performance()
        player.add_drum("kettle")
        player.drum_command("kettle", "strike 0.25 0 1")
        player.process(0.1)
        sound, displacement = np.zeros(2000), np.zeros(2000)
        himc.lib.himc_drum_read(himc.lib.himc_performance_drum(player._session.performance, 0), 2000, len(sound),
                                *(himc.ffi.cast("double *", x.ctypes.data) for x in (sound, displacement)))
        self.assertTrue(sound.any())
        self.assertFalse(displacement.any())

    def test_modes_are_those_of_the_program(self):
        firsts = []
        for text in ("", "drum d 20; d tune C4; stroke 1 right accent f;", XYLOPHONE):
            (self.at / "drum.txt").write_text(text)
            path = [self.at / "drum.txt"] if text else []
            rows = json.loads(self.program("modes", "--json", *path).stdout)
            mine = himc.modes(*path)
            self.assertEqual(len(mine), len(rows))
            for field, key in (("m", "m"), ("n", "n"), ("frequency", "frequency_hz"), ("ratio", "ratio"), ("t60", "t60_s")):
                np.testing.assert_allclose(mine[field], [row[key] for row in rows], atol=1e-5)
            firsts.append(mine["frequency"][0])
        self.assertEqual(len(set(firsts)), 3)

    def test_refusals_are_the_librarys_lines(self):
        with self.assertRaisesRegex(himc.Error, "a command for a drum, not for the performer"):
            himc.render("strike 1;")
        with self.assertRaisesRegex(himc.Error, "cannot be read"):
            himc.render("none.txt")
        with self.assertRaisesRegex(himc.Error, "which is not read: import it into Blender"):
            himc.Take("a.fbx")
        with self.assertRaisesRegex(himc.Error, "BPM"):
            himc.Performance().command("tempo 0")

    def test_a_misspelt_spot_is_an_error_that_names_spots_and_drums(self):
        with self.assertRaises(himc.Error) as caught:
            himc.render("tempo 90;\nstroke 1 right accent f rmi;")
        self.assertEqual(str(caught.exception), "score:2: rmi: no spot (center normal rim crossstick rimshot click shell), not dead, "
                         "no drum (kettle), did you mean rim?")
        p = himc.Performance()
        p.add_drum("tom")
        with self.assertRaisesRegex(himc.Error, r"no drum \(tom\)"):
            p.command("hit right accent f edge")
        p.command("hit right accent f centre tom")

    def test_a_score_in_text_takes_the_options_of_a_file(self):
        (self.at / "still.trc").write_text(
            "PathFileType\t4\t(X/Y/Z)\tstill.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\t"
            "OrigDataStartFrame\tOrigNumFrames\n100\t100\t2\t1\tmm\t100\t1\t2\nFrame#\tTime\tRTIP\t\t\n\t\tX1\tY1\tZ1\n\n"
            "1\t0\t1\t2\t3\n2\t0.01\t1\t2\t3\n")
        with self.assertRaisesRegex(himc.Error, 'left tip: no point "nope"'):
            himc.render(f"take {self.at / 'still.trc'};", left_tip="nope")

    @unittest.skipUnless(CAPTURE.exists(), "needs ../shared/mocap")
    def test_a_take_is_arrays_and_plays(self):
        take = himc.Take(CAPTURE)
        self.assertEqual(take.points.shape, (160, 5, 3))
        self.assertFalse(take.points.flags.owndata)
        self.assertEqual(len(take.strikes()), 1)
        self.assertEqual(himc.render(CAPTURE).stats["played"], 1)

    @unittest.skipUnless(CAPTURE.exists(), "needs ../shared/mocap")
    def test_one_subject_of_a_c3d_and_its_analog_channels(self):
        path = CAPTURE.parents[1] / "upperlimb_pyomeca_100hz/markers_analogs.c3d"
        take = himc.Take(path, subject="Daphnee")
        self.assertTrue(all(name.startswith("Daphnee:") for name in take.names))
        self.assertEqual(take.analog.shape, (11600, 38))
        self.assertEqual((take.analog_rate, take.analog_names[6]), (2000, "Delt_ant.EMG1 (V)"))
        self.assertTrue(0 < np.abs(take.analog[:, 6]).max() < 1)
        with self.assertRaisesRegex(himc.Error, "no subject bob, expected boite Daphnee"):
            himc.Take(path, subject="bob")

    @unittest.skipUnless(CAPTURE.exists(), "needs ../shared/mocap")
    def test_evaluate_has_a_row_for_each_controller(self):
        rows = himc.evaluate([CAPTURE])
        self.assertEqual(len(rows), 7)
        self.assertLess(rows[-1]["rms_percent"], 1)

    def test_the_example_of_the_documentation_runs(self):
        self.program("render", ROOT / "patches/improvisation.txt", "-o", "improvisation.wav", "--motion", "motion.npz", "--columns",
                     "all", "--quiet")
        text = (ROOT / "docs/data.md").read_text()
        example = re.search(r"```python\n(.*?)```", text, re.S).group(1)
        exec(compile(example.replace("motion.npz", str(self.at / "motion.npz")), "docs/data.md", "exec"), {})

    def test_the_notebook_remakes_its_figure(self):
        book = json.loads((ROOT / "python/strokes.ipynb").read_text())
        names = {}
        import matplotlib
        matplotlib.use("Agg")
        for cell in book["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), "strokes.ipynb", "exec"), names)
        self.assertEqual(len(names["figure"].axes), 2)
        # figure 5: an accent is prepared higher than a legato stroke, and strikes harder
        self.assertGreater(names["height"]["accent"].max(), names["height"]["legato"].max())
        self.assertGreater(names["force"]["accent"], names["force"]["legato"])

    def test_speed_is_that_of_the_program(self):
        """10 s of the improvisation; printed, and held only to half, since other work may run beside."""
        score = "\n".join(line for line in (ROOT / "patches/improvisation.txt").read_text().splitlines()[:30])
        (self.at / "ten.txt").write_text(score)
        times = {}
        for turn in range(2):
            start = time.process_time()
            seconds = len(himc.render(self.at / "ten.txt", motion=False).sound) / 48000
            times["package"] = min(times.get("package", 9e9), time.process_time() - start)
            import resource
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.program("render", "ten.txt", "-o", "ten.wav", "--quiet")
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            times["program"] = min(times.get("program", 9e9), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        share = times["program"] / times["package"]
        print(f"\n{seconds:.1f} s of piece: program {times['program']:.2f} s, package {times['package']:.2f} s, {100 * share:.0f} %")
        self.assertGreater(share, 0.5)


if __name__ == "__main__":
    unittest.main()
