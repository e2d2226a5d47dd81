"""Unity's lines for tests in Python."""

import traceback


class Ignored(Exception):
    pass


def run(file, tests):
    failures = ignored = 0
    for test in tests:
        name = f"{file}:0:{test.__name__}"
        try:
            said = test()
            print(f"{name}:PASS" + (f" {said}" if said else ""), flush=True)
        except Ignored as why:
            ignored += 1
            print(f"{name}:IGNORE: {why}", flush=True)
        except Exception as error:  # a test may fail in any way
            failures += 1
            where = traceback.extract_tb(error.__traceback__)[-1]
            print(
                f"{name}:FAIL: {type(error).__name__}: {error} ({where.line})".replace("\n", " "),
                flush=True,
            )
    print("-----------------------")
    print(f"{len(tests)} Tests {failures} Failures {ignored} Ignored")
    return failures > 0
