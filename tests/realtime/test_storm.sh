#!/bin/sh
# tests/cli/test_storm.sh for a minute, and how late blocks are in a storm and beside an equal load that sends nothing.
HIMC_STORM_LATENESS=1 exec tests/cli/test_storm.sh
