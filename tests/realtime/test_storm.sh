#!/bin/sh
# tests/test_storm.sh, and how late blocks are in a storm beside a run without one.
HIMC_STORM_LATENESS=1 exec tests/test_storm.sh
