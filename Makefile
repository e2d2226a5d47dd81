# himc: a virtual timpanist for Pure Data. `make help` lists what can be made.

# settings, to override on the command line: make ARCH=-march=native, make install PREFIX=/usr
BUILD     ?= build
PREFIX    ?= /usr/local
LIBDIR    ?= $(PREFIX)/lib
PDEXTRA   ?= $(PREFIX)/lib/pd-externals
UNITY_DIR ?= build/unity/src
EIGEN     ?= /usr/include/eigen3
ARCH      ?=
SANITIZE  ?=
STRIP     ?= strip
V         ?=
JOBS      ?= $(shell nproc 2>/dev/null || echo 1)
ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := $(subst gcc,g++,$(subst clang,clang++,$(CC)))
endif

# what every C file is compiled with (no flag changes a result); CPPFLAGS, CFLAGS and LDFLAGS of the user come last
OPTIMIZE = -O3 -fno-math-errno -fno-trapping-math -g $(ARCH)
WARNINGS = -Wall -Wextra -Wpedantic -Wshadow
HOW      = $(OPTIMIZE) $(WARNINGS) -fvisibility=hidden -fno-semantic-interposition -ffp-contract=off -fPIC $(SANITIZE) \
           -Ilib -Ilib/src -MMD -MP $(CPPFLAGS) $(CFLAGS)
COMPILE  = $(CC) -std=c17 -Wmissing-prototypes $(HOW)
# Eigen, which linear.cpp alone knows; the names of its templates would be 40 MB of each program; the two checks need a C++ run
# time of their own
comma := ,
COMPILE_CXX = $(CXX) -std=c++17 -isystem $(EIGEN) $(HOW) $(if $(findstring -g0,$(HOW)),,-g1) $(if $(findstring clang,$(CXX)),-fno-sanitize=function$(comma)vptr)
LINK     = $(CC) $(SANITIZE) $(LDFLAGS)
UNITY    = -DUNITY_INCLUDE_DOUBLE= -isystem $(UNITY_DIR)
# what the library needs, and what the program needs beside it
LIB_LIBS = -lode -lexpat -lz -lstdc++ -lpthread -lm
LIBS     = $(AS_NEEDED) -lsndfile $(LIB_LIBS)
AS_NEEDED = -Wl,--as-needed

# what is built from what is there
version    = $(shell sed -n 's/.*define HIMC_VERSION_$(1) //p' lib/himc/base.h)
MAJOR     := $(call version,MAJOR)
VERSION   := $(MAJOR).$(call version,MINOR).$(call version,PATCH)
LIBRARY   := $(BUILD)/libhimc.a
SHARED    := $(BUILD)/libhimc.so.$(VERSION)
LINK_SHARED = -shared -Wl,-soname,libhimc.so.$(MAJOR) -Wl,-Bsymbolic-functions -Wl,-z,defs $(AS_NEEDED)
PD_ENDING := pd_linux
# macOS, with clang as gcc: not tried on one (docs/pd.md)
ifneq ($(findstring darwin,$(shell $(CC) -dumpmachine)),)
LIB_LIBS    = -lode -lexpat -lz -lc++ -lm
AS_NEEDED   =
SHARED     := $(BUILD)/libhimc.$(VERSION).dylib
LINK_SHARED = -dynamiclib -install_name @rpath/libhimc.$(VERSION).dylib
PD_ENDING  := pd_darwin
endif
PKGCONFIG := $(BUILD)/himc.pc
PROGRAM   := $(BUILD)/bin/himc$(EXE)
VIEWER    := $(BUILD)/bin/himc-viewer
EXTERNALS := $(patsubst pd-externals/%.c,$(BUILD)/externals/himc/%.$(PD_ENDING),$(wildcard pd-externals/*~.c))
# for Pd with samples of 64 bits, and for libpd with several instances
EXTERNALS_64    := $(EXTERNALS:$(BUILD)/externals/%.$(PD_ENDING)=$(BUILD)/externals-64/%.linux-amd64-64.so)
EXTERNALS_MULTI := $(EXTERNALS:$(BUILD)/externals/%=$(BUILD)/externals-multi/%)
# the rooms of the library, in the order of the data flow
ROOMS     := system base body capture track plan midi musicxml control bank head drum performance osc
LIB_O     := $(foreach room,$(ROOMS),$(patsubst lib/src/%,$(BUILD)/lib/%.o,$(basename $(wildcard lib/src/$(room)/*.c lib/src/$(room)/*.cpp))))
# the page in one file, for himc share, where the viewer can be built
SHARE_O   := $(if $(EXE),,$(if $(wildcard /usr/share/javascript/three/three.module.js),$(patsubst %,$(BUILD)/viewer/%.o,pages recording scene share)))
# the sound card of himc play, where PortAudio is
PORTAUDIO := $(if $(EXE)$(findstring aarch64,$(CC)),,$(wildcard /usr/include/portaudio.h /usr/local/include/portaudio.h))
VIEWER_O  := $(patsubst viewer/%.c,$(BUILD)/viewer/%.o,$(wildcard viewer/*.c))
MOCAP_O   := $(patsubst mocap/%.c,$(BUILD)/mocap-o/%.o,$(filter-out mocap/generate.c,$(wildcard mocap/*.c)))
TOOL_O    := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(LEFT_OUT:%=tools/himc/%.c),$(wildcard tools/himc/*.c)))
# the tests of a room in the room's folder, of whole performances in session; their programs lie side by side in build/tests
UNIT_C    := $(wildcard $(patsubst %,tests/%/test_*.c,$(ROOMS) session viewer))
UNIT      := $(patsubst %.c,$(BUILD)/tests/%,$(notdir $(UNIT_C)))
LONG      := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/long/test_*.c))
FUZZ      := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/fuzz/fuzz_*.c))
REALTIME  := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/realtime/test_*.c))
# scripts: those that look at pages in a browser, which take longest, and the others
PAGES     := $(wildcard tests/page/test_*.sh) $(addprefix tests/viewer/test_viewer_,look.sh page.sh page_edit.sh)
SCRIPTS   := $(filter-out tests/pd/test_package.sh $(PAGES),$(foreach folder,cli docs pd viewer,$(wildcard tests/$(folder)/test_*.sh)))
CLIPS     := $(BUILD)/clips/clips.txt
UNITY_O   := $(BUILD)/tests/unity.o
WEBSOCKETS := $(firstword $(wildcard /usr/include/libwebsockets.h /usr/local/include/libwebsockets.h))
SOURCES   := $(wildcard lib/himc/*.h lib/src/*/*.[ch] lib/src/*/*.cpp tools/himc/*.[ch] tools/research/*/*.[ch] pd-externals/*.[ch] viewer/*.[ch] mocap/*.[ch] \
             tests/*/*.[ch])

MAKEFLAGS += --no-builtin-rules --no-print-directory
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
# several goals, as in `make demo test`, share a build: one after the other
ifneq ($(word 2,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif
.SUFFIXES:
.SECONDARY:
.DELETE_ON_ERROR:

# pd-lib-builder leaves its objects beside the sources, so it works on a copy (which make -n does not make); the first word of
# the argument is the folder, the others are for pd-externals/Makefile
define make_externals
	$(Q)rm -rf $(firstword $(1)) && mkdir -p $(firstword $(1)) && cp -r pd-externals $(firstword $(1))/work
	+$(Q)test ! -d $(firstword $(1))/work || $(MAKE) -C $(firstword $(1))/work install DESTDIR= PDLIBDIR=$(abspath $(firstword $(1))) \
	    CC="$(CC)" LIB=$(CURDIR)/lib ARCHIVE=$(abspath $(LIBRARY)) EXTRA_CFLAGS="$(ARCH) $(CFLAGS)" $(wordlist 2,9,$(1)) >$(firstword $(1)).log
	$(Q)rm -r $(firstword $(1))/work
endef

##@ Build
all: $(if $(wildcard $(VIEWER)),$(VIEWER)) $(LIBRARY) $(SHARED) $(PKGCONFIG) $(PROGRAM) $(EXTERNALS) $(CLIPS) ## the library, the program, the externals and their clips (default)

deps: ## install what is missing of tools/build/deps.txt (Debian packages; root or sudo)
	@tools/build/deps.sh tools/build/deps.txt

externals-64: $(EXTERNALS_64) ## the externals for Pd with samples of 64 bits, in build/externals-64

externals-multi: $(EXTERNALS_MULTI) ## the externals for libpd with several instances in one process, in build/externals-multi

# a compiler whose programs load on systems of 2020, too (tools/build/root.sh)
OLDER = CC=$(abspath $(1)/bin)/$(2)-linux-gnu-gcc CXX=$(abspath $(1)/bin)/$(2)-linux-gnu-g++
# a Pure Data of those years, which tries what is built on their C library
OLDER_PD = puredata-core libasound2 libjack-jackd2-0 libportaudio2 libsamplerate0 libdb5.3 libopus0 libgcc-s1 libstdc++6
linux: deps ## the externals, of 32 and of 64 bits, for Linux with glibc 2.31 and newer, in build/linux
	@tools/build/root.sh $(BUILD)/linux/debian amd64 $(OLDER_PD)
	@$(MAKE) linux-here BUILD=$(BUILD)/linux $(call OLDER,$(BUILD)/linux/debian,x86_64)
linux-here: $(EXTERNALS) $(EXTERNALS_64)

arm64: deps ## program and externals for Linux on arm64 with glibc 2.31 and newer, crossed, in build/arm64
	@tools/build/deps.sh tools/build/deps-arm64.txt
	@tools/build/root.sh $(BUILD)/arm64/debian arm64 libode8 libccd2 libsndfile1-dev libsndfile1 libflac8 libvorbis0a libvorbisenc2 libogg0 libexpat1 \
	    zlib1g $(OLDER_PD)
	@$(MAKE) $(TABLE)
	@$(MAKE) arm64-here BUILD=$(BUILD)/arm64 $(call OLDER,$(BUILD)/arm64/debian,aarch64) TABLE=$(TABLE)
arm64-here: $(PROGRAM)
	@echo "pd   $(BUILD)/externals"
	$(call make_externals,$(BUILD)/externals extension=l_arm64 OBJCOPY=aarch64-linux-gnu-objcopy)
# the vectorizer of GCC 12 for arm64 ends with an internal error here
$(BUILD)/tools/himc/live.o: private CFLAGS += $(if $(findstring aarch64,$(CC)),-fno-tree-loop-vectorize)

test-arm64: all ## the same, run by qemu: its strikes and its sound are those of this machine
	@$(MAKE) arm64
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh tests/cross/test_arm64.sh

WINDOWS = $(abspath $(BUILD)/windows/parts/root)
windows: deps ## program and externals for Windows, crossed by mingw-w64, in build/windows
	@tools/build/deps.sh tools/build/deps-windows.txt
	@tools/build/windows.sh $(BUILD)/windows/parts
	@$(MAKE) windows-here BUILD=$(BUILD)/windows CC=x86_64-w64-mingw32-gcc EXE=.exe WINDOWS=$(WINDOWS) LDFLAGS="-static -L$(WINDOWS)/lib" \
	    CPPFLAGS="-D__USE_MINGW_ANSI_STDIO=1 -I$(WINDOWS)/include -DXML_STATIC" CFLAGS="-Wno-format -Wa,-muse-unaligned-vector-move $(CFLAGS)" \
	    LIB_LIBS="-lode -lexpat -lz -lstdc++ -lpthread -lws2_32 -lm" LEFT_OUT="evaluate% trial pool browser edit%"
windows-here: $(PROGRAM)
	@echo "pd   $(BUILD)/externals"
	$(call make_externals,$(BUILD)/externals extension=m_amd64 ARCHIVES=$(WINDOWS)/lib PDBINDIR=$(WINDOWS)/lib PDINCLUDEDIR=/usr/include/pd)

test-windows: all ## the same, run by wine: its strikes are those of Linux, in the program and in Pure Data
	@$(MAKE) windows
	@tools/build/windows.sh $(BUILD)/windows/parts pd
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh tests/cross/test_windows.sh

# the library compiled to WebAssembly, without threads, sockets and ODE, and what a page asks of it
page: deps ## the performer in a web page, build/himc.html: nothing to install, no server, no network
	@tools/build/deps.sh tools/build/deps-page.txt
	@$(MAKE) $(BUILD)/himc.html

MACOS = $(abspath $(BUILD)/macos/parts)
check-macos: deps ## all of it crossed to macOS on arm64 and linked, in build/macos; none of it has been run
	@tools/build/deps.sh tools/build/deps-macos.txt
	@tools/build/macos.sh $(BUILD)/macos/parts
	@$(MAKE) $(TABLE)
	@$(MAKE) macos-here BUILD=$(BUILD)/macos MACOS=$(MACOS) CC=$(MACOS)/bin/cc CXX=$(MACOS)/bin/c++ AR=$(MACOS)/bin/ar LDFLAGS=-L$(MACOS)/root/lib TABLE=$(TABLE) PORTAUDIO= \
	    CPPFLAGS="-isystem $(MACOS)/root/include" CFLAGS="-Werror -Wno-unused-command-line-argument $(CFLAGS)"
	@grep -hoE '[A-Za-z_0-9]+' /usr/include/pd/m_pd.h /usr/include/pd/m_imp.h /usr/include/pd/g_canvas.h | sort -u >$(BUILD)/macos/pd.txt
	@tests/cross/test_macos.sh $(BUILD)/macos
macos-here: $(PROGRAM) $(SHARED)
	@echo "pd   $(BUILD)/externals"
	$(call make_externals,$(BUILD)/externals extension=d_arm64 ARCHIVES=$(MACOS)/root/lib PDINCLUDEDIR=/usr/include/pd)

deb: deps ## Debian packages (libhimc0, libhimc-dev, himc, himc-viewer, pd-himc), in build/debian, held against lintian
	@tools/build/deps.sh tools/build/deps-debian.txt tools/build/deps-viewer.txt
	@tools/build/deb.sh $(BUILD)

deken: deps ## the package for Pd's package manager, in build/package, tried as a new user would
	@tools/build/deps.sh tools/build/deps-package.txt
	@$(MAKE) all
	@$(MAKE) linux
	@$(MAKE) arm64
	@$(MAKE) windows
	@tools/build/package.sh $(BUILD) $(VERSION)
	@HIMC_BUILD=$(BUILD) tests/pd/test_package.sh $(BUILD)/package/*.dek

INSTALL = BUILD=$(BUILD) DESTDIR="$(DESTDIR)" PREFIX="$(PREFIX)" LIBDIR="$(LIBDIR)" PDEXTRA="$(PDEXTRA)" VERSION=$(VERSION) STRIP="$(STRIP)" tools/build/install.sh
install: all ## install program, library, headers, externals, patches, manual pages and completions under PREFIX (DESTDIR for packagers; STRIP= keeps what debuggers need)
	@$(INSTALL) install

uninstall: all ## remove what `make install` put there, nothing else
	@$(INSTALL) uninstall

clean: ## remove all that was built
	rm -rf build

##@ Play
demo: deps ## install, build, play the improvisation headless; leaves its sound and picture in build/demo
	@$(MAKE) all
	@tools/build/demo.sh

mocap: $(BUILD)/bin/generate ## write the motion database, 45 sequences, into build/mocap
	@mkdir -p $(BUILD)/mocap
	$(BUILD)/bin/generate $(BUILD)/mocap

view: deps ## build the viewer and show the improvisation in the browser
	@tools/build/deps.sh tools/build/deps-viewer.txt
	@$(MAKE) $(PROGRAM) $(VIEWER)
	@mkdir -p $(BUILD)/demo
	$(PROGRAM) render patches/improvisation.txt -o $(BUILD)/demo/view.wav --scene $(BUILD)/demo/view.himc
	$(VIEWER) --play $(BUILD)/demo/view.himc

# Debian's, for which deps installs numpy and others, before one of the user's own
PYTHON ?= $(firstword $(wildcard /usr/bin/python3) python3)

# the picture of `make still`: the camera (stage front side top eye) and the time (s)
CAMERA ?= stage
AT     ?= 20.2
still: deps ## a picture of it, by a browser without a window, in build/demo/still.png; CAMERA=eye AT=20.2
	@tools/build/deps.sh tools/build/deps-viewer.txt tools/build/deps-browser.txt
	@$(MAKE) $(PROGRAM) $(VIEWER)
	@mkdir -p $(BUILD)/demo
	$(PROGRAM) render patches/improvisation.txt -o $(BUILD)/demo/view.wav --scene $(BUILD)/demo/view.himc
	HIMC_BUILD=$(BUILD) $(PYTHON) tests/viewer/still.py $(BUILD)/demo/view.himc $(BUILD)/demo/still.png $(AT) $(CAMERA)

viewer: ## the viewer alone, build/bin/himc-viewer
	@tools/build/deps.sh tools/build/deps-viewer.txt
	@$(MAKE) $(VIEWER)

##@ Test
test: deps ## install, build, run all tests; the last line is `N passed, N failed`
	@$(MAKE) check

units: $(UNIT) $(FUZZ)

# the page that plays by itself, for its tests, where its compiler is
PAGE := $(if $(wildcard /usr/bin/clang-16),$(if $(wildcard /usr/lib/wasm32-wasi/libc++.a),$(BUILD)/himc.html))

# what docs/results/papers.md asks of the library
MEASURE := $(BUILD)/tools/research/papers/measure

check: all units $(MEASURE) $(WATCH) $(if $(WEBSOCKETS),$(VIEWER)) ## the same without installing
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh $(SCRIPTS) $(UNIT) $(FUZZ)

test-page: deps ## the tests of the pages, viewer's and himc.html, in Chromium and Firefox without a window
	@tools/build/deps.sh tools/build/deps-viewer.txt tools/build/deps-browser.txt tools/build/deps-page.txt
	@$(MAKE) check-page

check-page: all $(PAGE) $(if $(WEBSOCKETS),$(VIEWER))
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh $(PAGES)

test-long: deps ## all tests at full length, and those too slow for every day
	@$(MAKE) check-long

check-long: all units $(MEASURE) $(WATCH) $(PAGE) $(LONG) $(if $(WEBSOCKETS),$(VIEWER))
	@HIMC_BUILD=$(BUILD) HIMC_LONG=1 TEST_TIMEOUT=1800 tests/run.sh $(LONG) $(PAGES) $(SCRIPTS) $(UNIT) $(FUZZ)

axe: ## axe-core of npm: with it the page's tests look for what shuts people out
	@mkdir -p $(BUILD)/axe
	@cd $(BUILD)/axe && npm pack --silent axe-core@4.10.3 && tar -xzf axe-core-4.10.3.tgz --strip-components=1 package/axe.min.js

test-asan: deps ## the tests in C, and the viewer's, under the address and undefined behaviour sanitizers
	@$(MAKE) check-asan BUILD=build/asan SANITIZE="-fsanitize=address,undefined -fno-sanitize-recover=undefined"

check-asan: units $(if $(TOOL_O),$(PROGRAM)) $(if $(WEBSOCKETS),$(VIEWER))
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh $(UNIT) $(FUZZ) $(if $(WEBSOCKETS),tests/viewer/test_viewer.sh)

# the tests with several threads: of the network, and of the loader
THREADED := $(filter $(BUILD)/tests/test_osc% $(BUILD)/tests/test_loader%,$(UNIT))
test-tsan: deps ## the tests with several threads under the thread sanitizer
	@$(MAKE) check-tsan BUILD=build/tsan SANITIZE=-fsanitize=thread

check-tsan: $(THREADED)
	@HIMC_BUILD=$(BUILD) TEST_TIMEOUT=900 tests/run.sh $(THREADED)

clang: deps ## all of it compiled by clang, whose warnings are errors
	@tools/build/deps.sh tools/build/deps-clang.txt
	@$(MAKE) units build/clang/bin/himc $(if $(WEBSOCKETS),build/clang/bin/himc-viewer) BUILD=build/clang CC=clang CFLAGS="$(CFLAGS) -Werror -g0"

# of the tests' scripts those that run nothing but the program
COVERED := $(addprefix tests/cli/test_,cli.sh evaluate.sh osc_serve.sh osc_vmc.sh)
coverage: deps ## the share of lib/ that the tests run, at least 97 %; what they do not run is in build/coverage/coverage.txt
	@tools/build/deps.sh tools/build/deps-coverage.txt
	@$(MAKE) check-coverage BUILD=build/coverage SANITIZE="--coverage -fprofile-update=atomic" CFLAGS=-O1

check-coverage: units $(PROGRAM)
	@find $(BUILD) -name '*.gcda' -delete
	@GCOV_ERROR_FILE=/dev/null HIMC_BUILD=$(BUILD) TEST_TIMEOUT=1800 tests/run.sh $(UNIT) $(FUZZ) $(COVERED)
	@gcovr -j $(JOBS) --root . --filter lib/ --exclude-unreachable-branches --txt $(BUILD)/coverage.txt \
	    --print-summary --fail-under-line 97 $(BUILD)/lib

golden: deps ## write the bits of the sessions in tests/golden, where a change is to change them: tests/golden/bits.txt
	@$(MAKE) $(BUILD)/tests/test_golden
	$(BUILD)/tests/test_golden $(patsubst tests/golden/%.txt,%,$(filter-out %/bits.txt,$(wildcard tests/golden/*.txt)))

# how long each target runs (s)
FUZZ_SECONDS ?= 60
fuzz: deps ## arbitrary bytes to all readers by clang's libFuzzer, FUZZ_SECONDS=60 each; FUZZ_TARGETS="bvh osc" only these
	@tools/build/deps.sh tools/build/deps-fuzz.txt
	@$(MAKE) check-fuzz BUILD=build/fuzz CC=clang LIBFUZZER=-fsanitize=fuzzer \
	    SANITIZE="-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined"

FUZZ_TARGETS ?= $(patsubst $(BUILD)/tests/fuzz/fuzz_%,%,$(FUZZ))
check-fuzz: $(FUZZ_TARGETS:%=$(BUILD)/tests/fuzz/fuzz_%)
	@tools/build/fuzz.sh $(BUILD) $(FUZZ_SECONDS) $^

# how many commands `make torment` sends, and the seed of their order
COMMANDS ?= 1000000
SEED     ?= 1
torment: deps ## a million random and hostile commands to a playing performance; COMMANDS=1000000 SEED=1
	@$(MAKE) $(BUILD)/tests/test_torment
	HIMC_TORMENT=$(COMMANDS) HIMC_SEED=$(SEED) $(BUILD)/tests/test_torment

# how many hours `make soak` plays, and at which physics rate (Hz)
HOURS ?= 24
PHYSICS ?= 10000
soak: deps ## a session of HOURS=24 simulated hours (SEED=1 PHYSICS=10000): no drift, no growth, every stroke played; a line per hour
	@$(MAKE) $(BUILD)/tests/test_soak
	HIMC_HOURS=$(HOURS) HIMC_SEED=$(SEED) HIMC_PHYSICS=$(PHYSICS) $(BUILD)/tests/test_soak

# of how many mutants, from which room
COUNT ?= 200
ROOM  ?=
mutants: deps $(UNITY_DIR)/unity.c ## faults drawn at random, put into the library one at a time; what no unit test notices is told (SEED=1 COUNT=200 ROOM=plan)
	@mkdir -p $(BUILD)
	@HIMC_BUILD=$(BUILD) COMPILE="$(COMPILE)" SEED=$(SEED) COUNT=$(COUNT) ROOM=$(ROOM) tests/mutants/mutants.py

# the externals for it, of 32 or 64 bits
FLOATSIZE ?= 32
test-pd: deps ## the tests in another Pd than the machine's: NEWER=/its/bin/pd FLOATSIZE=32 or 64
	@$(MAKE) all $(if $(filter 64,$(FLOATSIZE)),externals-64)
	@HIMC_BUILD=$(BUILD) PD=$(NEWER) $(if $(filter 64,$(FLOATSIZE)),HIMC_EXTERNALS=$(abspath $(BUILD)/externals-64)) HIMC_LONG=1 JOBS=1 \
	    tests/run.sh tests/pd/test_pd.sh tests/pd/test_patches.sh tests/pd/test_save.sh

test-libpd: deps ## a program with Pure Data and both objects in it, one and four instances: LIBPD=its/source (with pure-data)
	@tools/build/deps.sh tools/build/deps-libpd.txt
	@$(MAKE) all
	@LIBPD=$(abspath $(LIBPD)) HIMC_BUILD=$(BUILD) TEST_TIMEOUT=1800 tests/run.sh tests/libpd/test_libpd.sh

test-realtime: deps ## what only the wall clock can show: rates, latencies, computing times; on a machine at rest
	@$(MAKE) check-realtime

check-realtime: all $(REALTIME)
	@HIMC_BUILD=$(BUILD) JOBS=1 TEST_TIMEOUT=900 tests/run.sh $(REALTIME) $(wildcard tests/realtime/test_*.sh)

# how much of each file is played (s)
MIDI_SECONDS ?= 15
test-midi: deps ## plays MIDI files of two games and holds what is struck against them (MIDI_SECONDS=15 of each; some minutes)
	@tools/build/deps.sh tools/build/deps-midi.txt
	@$(MAKE) $(PROGRAM)
	tests/midi/evaluate.py $(PROGRAM) $(MIDI_SECONDS) $$(tests/midi/fetch.sh build/midi) tests/midi/*.mid patches/pieces/*.mid

# how much of each file is played (s)
MUSIC_SECONDS ?= 20
benchmark-music: deps ## 66 public MIDI and MusicXML files, imported and played: F1 of their notes, loudness, round trips (ten minutes)
	@$(MAKE) $(PROGRAM)
	@tools/research/music/fetch.sh $(BUILD)/music
	@test -d $(BUILD)/music/venv || { python3 -m venv $(BUILD)/music/venv && $(BUILD)/music/venv/bin/pip -q install mido==1.3.3 music21==10.5.1; }
	@$(BUILD)/music/venv/bin/python tools/research/music/benchmark.py $(PROGRAM) $(MUSIC_SECONDS) $(BUILD)/music tools/research/music/files.txt

test-python: deps ## the Python package, built and installed into build/python: against the program, docs/data.md, the notebook
	@tools/build/deps.sh tools/build/deps-python.txt
	@build/python/bin/python -c 'import cffi, setuptools as s; assert int(s.__version__.split(".")[0]) >= 77' 2>/dev/null || \
		{ python3 -m venv build/python && build/python/bin/pip -q install numpy cffi 'setuptools>=77' wheel matplotlib; }
	@build/python/bin/pip -q install gymnasium==1.4.0 mujoco==4.0.0 opensim==4.6 ezc3d==1.7.2
	@build/python/bin/pip -q install ray==2.60.0 || echo "no ray: its test is skipped"
	@build/python/bin/pip -q install --no-build-isolation --force-reinstall --no-deps ./python
	@build/python/bin/python python/tests/test_himc.py
	@build/python/bin/python python/tests/test_gym.py
	@build/python/bin/python python/tests/test_trials.py

levels: deps ## how loud the pieces are, by libebur128: -23 LUFS, true peaks below full scale (a minute)
	@tools/build/deps.sh tools/build/deps-sound.txt
	@$(MAKE) check-levels

check-levels: all $(BUILD)/tools/research/sound/loudness
	@HIMC_BUILD=$(BUILD) JOBS=1 TEST_TIMEOUT=900 tests/run.sh tests/sound/test_levels.sh

sound-report: deps ## how near the timpano is to recorded ones: table and plot in build/sound-report (a minute)
	@tools/build/deps.sh tools/build/deps-sound.txt
	@$(MAKE) check-sound-report

check-sound-report: all $(BUILD)/tools/research/sound/loudness
	@$(PYTHON) tools/research/sound/report.py $(PROGRAM) $(BUILD)/sound-report
	@gnuplot -e "folder='$(BUILD)/sound-report'" tools/research/sound/report.gp

bench: deps ## what a step, a mode and a performer cost on this machine
	@$(MAKE) check-bench

check-bench: all
	@$(PROGRAM) bench

bench-page: page ## what the page needs on this machine, in a browser without a window
	@tools/build/deps.sh tools/build/deps-browser.txt
	@$(PYTHON) tests/page/bench.py $(abspath $(BUILD))/himc.html

bench-peers: deps ## the same, then other programs: MuJoCo, Faust, STK, Csound, SuperCollider, pmpd~
	@tools/build/deps.sh tools/build/deps-peers.txt
	@test -d build/peers || { python3 -m venv build/peers && build/peers/bin/pip -q install mujoco==4.0.0 dm_control==1.0.50; }
	@$(MAKE) all
	@$(PROGRAM) bench --peers

##@ Documentation
figures: deps ## draw the pictures and play the sounds of docs into build/figures and build/sounds
	@tools/build/deps.sh tools/build/deps-figures.txt
	@$(MAKE) check-figures

trials: deps ## play the trials behind the figures again, 90 minutes of processor time: writes docs/figures/*.csv
	@$(MAKE) check-trials

papers: $(PROGRAM) $(BUILD)/tools/research/papers/measure ## remake the table of the papers in docs/results/papers.md and the trials' tables of evaluation.md
	@HIMC_BUILD=$(BUILD) tools/research/papers/papers.sh >$(BUILD)/papers.md
	@sed '/^| place |/,$$d' docs/results/papers.md | cat - $(BUILD)/papers.md >$(BUILD)/papers.new && mv $(BUILD)/papers.new docs/results/papers.md
	@awk -f tools/research/papers/evaluation.awk docs/figures/spread.csv docs/figures/database.csv docs/results/evaluation.md >$(BUILD)/papers.new
	@mv $(BUILD)/papers.new docs/results/evaluation.md
	@echo "wrote docs/results/papers.md and the tables of docs/results/evaluation.md"

air-table: ## lib/src/head/air_table.c anew (a minute): the modes of five timpani in air
	@$(MAKE) $(BUILD)/tools/research/air/table
	$(BUILD)/tools/research/air/table >$(BUILD)/air_table.c
	cmp -s $(BUILD)/air_table.c lib/src/head/air_table.c || mv $(BUILD)/air_table.c lib/src/head/air_table.c

regression-table: ## lib/src/control/posture_regression_table.c anew: how arms move with their sticks, from the database
	@$(MAKE) $(BUILD)/tools/research/regression/table
	$(BUILD)/tools/research/regression/table >$(BUILD)/posture_regression_table.c
	mv $(BUILD)/posture_regression_table.c lib/src/control/posture_regression_table.c

##@ Style
manual: $(BUILD)/tests/test_manual ## write the library's vocabulary into docs/manual.md
	@HIMC_WRITE_MANUAL=1 $< >/dev/null && echo "wrote docs/manual.md"

lint: ## formatting, warnings as errors, cppcheck, the one-way order of the rooms
	@tools/build/deps.sh tools/build/deps.txt tools/build/deps-lint.txt
	@$(MAKE) all units BUILD=build/lint CFLAGS="$(CFLAGS) -Werror"
	@tools/build/lint.sh build/lint $(SOURCES)

reference: ## the public headers and the Python package as web pages, build/reference/index.html (doxygen); no warning is let pass
	@tools/build/deps.sh tools/build/deps-reference.txt
	@mkdir -p $(BUILD)
	doxygen docs/Doxyfile

format: ## let clang-format lay out all C files
	@tools/build/deps.sh tools/build/deps-lint.txt
	clang-format -i $(SOURCES)

help: ## this list
	@awk -F ':.*## ' '/^##@/ {print "\n" substr($$0, 5)} /^[a-z0-9-]+:.*## / {printf "  make %-13s %s\n", $$1, $$2}' Makefile

# all that is named without a folder
.PHONY: FORCE $(shell sed -n 's/^\([a-z0-9-]*\):.*/\1/p' Makefile)

# one rule per kind; V=1 shows the whole commands
Q   = $(if $(V),,@)
say = @mkdir -p $(@D) $(if $(V),,&& echo "$(1) $@")

$(LIBRARY): $(LIB_O)
	$(call say,ar  )
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(SHARED): $(LIB_O)
	$(call say,link)
	$(Q)$(LINK) $(LINK_SHARED) $^ $(LIB_LIBS) -o $@

# made anew each time, since it holds paths of the command line; touched only when it changes
# pkg-config wants a space in a path quoted
EMPTY   :=
pc_path  = $(subst $(EMPTY) $(EMPTY),\\ ,$(1))

$(PKGCONFIG): tools/build/himc.pc.in FORCE
	@mkdir -p $(@D)
	@sed -e 's|@PREFIX@|$(call pc_path,$(PREFIX))|; s|@LIBDIR@|$(call pc_path,$(LIBDIR))|; s|@VERSION@|$(VERSION)|; s|@LIBS@|$(LIB_LIBS)|' $< >$@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(BUILD)/lib/%.o: lib/src/%.c
	$(call say,cc  )
	$(Q)$(COMPILE) -c $< -o $@

$(BUILD)/lib/%.o: lib/src/%.cpp
	$(call say,c++ )
	$(Q)$(COMPILE_CXX) -c $< -o $@

# the flags of a folder
IN_tools  = -I.
IN_tests  = -I. -Itests/support $(UNITY)
IN_viewer = -DMADE='"$(BUILD)/viewer"' -I$(BUILD)/viewer $(if $(findstring /engine/,$<),-I. -Iviewer)
$(BUILD)/%.o: %.c
	$(call say,cc  )
	$(Q)$(COMPILE) $(IN_$(firstword $(subst /, ,$<))) -c $< -o $@

# for himc --licences
$(BUILD)/tools/himc/licences.h: LICENSE LIBRARIES.txt
	$(call say,make)
	$(Q)(cat LICENSE; echo; cat LIBRARIES.txt) | sed 's/[\\"]/\\&/g; s/.*/"&",/' >$@
$(BUILD)/tools/himc/himc.o: private override CPPFLAGS += -I$(BUILD)/tools/himc
$(BUILD)/tools/himc/himc.o: $(BUILD)/tools/himc/licences.h

# small programs that make tables, figures and clips
$(BUILD)/tools/%: $(BUILD)/tools/%.o $(LIBRARY)
	$(call say,link)
	$(Q)$(LINK) $(filter %.o,$^) $(LIBRARY) $(LIBS) -o $@

# the timpano's own blows, which the clip technique replays
$(CLIPS): $(BUILD)/tools/research/clips/clips
	$(call say,play)
	$(Q)$< $(@D)

# names, parents and lengths of the body's segments, for the viewer and its page; the program that prints them needs its
# room base, the skeleton and no other package, so that `make viewer` needs none either
SKELETON_O := $(BUILD)/tools/research/skeleton/table.o $(BUILD)/lib/body/skeleton.o $(filter-out %/linear.o,$(filter $(BUILD)/lib/system/% $(BUILD)/lib/base/%,$(LIB_O)))
# of this machine: what is crossed for another does not run here
TABLE = $(BUILD)/tools/research/skeleton/table
$(BUILD)/tools/research/skeleton/table: $(SKELETON_O)
	$(call say,link)
	$(Q)$(LINK) $^ -lm -o $@

$(BUILD)/viewer/skeleton.h: $(TABLE)
	$(call say,make)
	$(Q)$< c >$@

$(BUILD)/viewer/skeleton.js: $(TABLE)
	$(call say,make)
	$(Q)$< js >$@

$(VIEWER_O) $(BUILD)/viewer/engine/engine.o: $(BUILD)/viewer/skeleton.h
$(BUILD)/viewer/pages.o: $(wildcard viewer/page/*) $(BUILD)/viewer/skeleton.js
-include $(VIEWER_O:.o=.d)
-include $(BUILD)/viewer/engine/engine.d $(BUILD)/viewer/engine/page.d

$(VIEWER): $(VIEWER_O) $(filter-out %/linear.o,$(filter $(BUILD)/lib/system/% $(BUILD)/lib/base/%,$(LIB_O)))
	$(call say,link)
	$(Q)$(LINK) $^ -Wl,--as-needed -llo -lwebsockets -lz -lm -o $@

# the pieces that the page brings
PAGE_PIECES := $(wildcard patches/improvisation.txt patches/pieces/*.txt patches/pieces/*.mid)
PAGE_MAKER  := $(BUILD)/viewer/engine/page
$(BUILD)/himc.html: $(PAGE_MAKER) $(BUILD)/page/engine.wasm $(PAGE_PIECES)
	$(call say,make)
	$(Q)$< $@ $(filter-out $<,$^)

# a page plays at 48 kHz in short blocks, and has no deadline: rings are as short as that needs, heads are made when
# their changes come. The samples are the same; what is copied for an edit is a third.
PAGE_ROOM := -DHIMC_DRUM_RING=1024 -DHIMC_EARS_LINE=8192 -DHIMC_ROOM_RATE=48000 -DMOST_SPARES=1
# Over all files at once (-flto) it runs a tenth faster. clang-16 runs Debian's wasm-opt, if that is installed, without
# SIMD, and fails: hence -O0.
$(BUILD)/page/parts/parts.o: tools/build/page.sh
	$(Q)$< $(@D)

$(BUILD)/page/engine.wasm: $(TABLE) $(BUILD)/page/parts/parts.o FORCE
	+$(Q)$(MAKE) page-here BUILD=$(BUILD)/page CC="clang-16 --target=wasm32-wasi" CXX="clang++-16 --target=wasm32-wasi -isystem /usr/lib/llvm-16/include/wasm32-wasi/c++/v1" \
	    ROOMS="$(filter-out osc,$(ROOMS))" CPPFLAGS="-DHIMC_NO_ODE -DHIMC_NO_SNDFILE $(PAGE_ROOM) -D_WASI_EMULATED_GETPID -isystem $(abspath $(BUILD))/page/parts/include" ARCH= SANITIZE= CFLAGS="-flto -msimd128 -mbulk-memory -fno-pic -fno-exceptions -g0 -Wno-unused-command-line-argument" \
	    LDFLAGS="-flto -O0 -Wl,-O3 -Wl,--lto-O3 -mexec-model=reactor -Wl,-z,stack-size=1048576 -Wl,--strip-all" TABLE=$(BUILD)/tools/research/skeleton/table
PAGE_LEFT_OUT := $(addprefix $(BUILD)/lib/,drum/loader.o system/thread.o system/udp.o)
PAGE_TOOLS := cli edit_journal edit_player edit_session edit_text live scene scene_record
page-here: $(BUILD)/engine.new
	$(Q)cmp -s $< $(BUILD)/engine.wasm || cp $< $(BUILD)/engine.wasm
# wasm-opt: a twentieth faster and smaller
$(BUILD)/engine.new: $(patsubst %,$(BUILD)/viewer/%.o,engine/engine engine/edit scene scene_encode) $(PAGE_TOOLS:%=$(BUILD)/tools/himc/%.o) $(filter-out $(PAGE_LEFT_OUT),$(LIB_O)) $(BUILD)/parts/parts.o
	$(call say,link)
	$(Q)$(CXX) $(LDFLAGS) $^ -lwasi-emulated-getpid -o $@
	$(Q)! command -v wasm-opt >/dev/null || wasm-opt -O3 --enable-simd --enable-bulk-memory --enable-sign-ext --enable-mutable-globals \
	    --enable-nontrapping-float-to-int $@ -o $@

$(PAGE_MAKER): $(BUILD)/viewer/engine/page.o $(SHARE_O) $(filter-out %/linear.o,$(filter $(BUILD)/lib/system/% $(BUILD)/lib/base/%,$(LIB_O)))
	$(call say,link)
	$(Q)$(LINK) $^ -lz -lm -o $@

$(UNIT_C:%.c=$(BUILD)/%.o) $(addsuffix .o,$(LONG) $(REALTIME)): | $(UNITY_DIR)/unity.c

# to be preloaded: counts the calls that may wait, for the real-time contract
WATCH := $(BUILD)/tests/watch.so
$(WATCH): tests/watch/watch.c
	$(call say,link)
	$(Q)$(CC) -std=c17 -O2 -g $(WARNINGS) -Wno-pedantic -fPIC -shared $< -ldl -o $@
$(BUILD)/tests/test_contract: | $(WATCH)

$(UNITY_O): $(UNITY_DIR)/unity.c
	$(call say,cc  )
	$(Q)$(CC) -O2 $(SANITIZE) $(UNITY) -c $< -o $@

$(BUILD)/mocap-o/%.o: mocap/%.c
	$(call say,cc  )
	$(Q)$(COMPILE) -c $< -o $@

$(BUILD)/bin/generate: $(BUILD)/mocap-o/generate.o $(MOCAP_O) $(LIBRARY)
	$(call say,link)
	$(Q)$(LINK) $^ $(LIBS) -o $@

$(BUILD)/tests/test_golden $(BUILD)/tests/test_mocap $(BUILD)/tests/test_mocap_strokes $(BUILD)/tools/research/regression/table: $(MOCAP_O)

$(addprefix $(BUILD)/tools/research/,figures/strokes figures/claim figures/database papers/measure): $(BUILD)/tools/himc/trial.o $(BUILD)/tools/himc/pool.o $(MOCAP_O)

$(BUILD)/tools/research/air/table $(BUILD)/tests/test_air $(BUILD)/tests/test_air_galerkin: $(BUILD)/tools/research/air/galerkin.o

$(BUILD)/tests/test_database: $(BUILD)/tools/himc/trial.o $(MOCAP_O)

# needs tools/build/deps-sound.txt
$(BUILD)/tools/research/sound/loudness: private LIBS += -lebur128

# names of files are UTF-8
$(BUILD)/tools/himc/windows.o: tools/build/windows.rc tools/build/windows.manifest
	$(Q)x86_64-w64-mingw32-windres -I tools/build $< $@
$(PROGRAM): $(if $(EXE),$(BUILD)/tools/himc/windows.o)

$(BUILD)/tools/himc/share.o $(BUILD)/tools/himc/film.o: private CPPFLAGS += -Iviewer $(if $(SHARE_O),-DHIMC_SHARE)
$(BUILD)/tools/himc/play.o: private CPPFLAGS += $(if $(PORTAUDIO),-DHIMC_PORTAUDIO)
$(PROGRAM): $(TOOL_O) $(MOCAP_O) $(SHARE_O) $(LIBRARY)
	$(call say,link)
	$(Q)$(LINK) $^ $(LIBS) $(if $(PORTAUDIO),-lportaudio) -o $@

# a test file is a program; it runs from the repository's root and finds what was built by HIMC_BUILD; those of OSC listen with liblo
$(foreach test,$(UNIT_C:.c=),$(eval $(BUILD)/tests/$(notdir $(test)): $(BUILD)/$(test).o))
$(LONG) $(REALTIME): $(BUILD)/tests/%: $(BUILD)/tests/%.o
$(UNIT) $(LONG) $(REALTIME): $(UNITY_O) $(LIBRARY)
	$(call say,link)
	$(Q)$(LINK) $(filter %.o,$^) $(LIBRARY) $(LIBS) -llo -o $@

# targets for arbitrary bytes: with clang's libFuzzer, or with a driver that mutates in the same way each time
$(FUZZ): $(BUILD)/tests/%: $(BUILD)/tests/%.o $(if $(LIBFUZZER),,$(BUILD)/tests/fuzz/driver.o) $(LIBRARY)
	$(call say,link)
	$(Q)$(LINK) $(LIBFUZZER) $(filter %.o,$^) $(LIBRARY) $(LIBS) -llo -o $@

$(BUILD)/tests/fuzz/%.o: private CPPFLAGS += -D_GNU_SOURCE # files in memory

# what of the viewer needs neither a socket nor a package of its own, for its tests
VIEWER_PARTS := $(filter-out $(addprefix $(BUILD)/viewer/,channel.o main.o pages.o receive.o share.o web.o),$(VIEWER_O))
VIEWER_TESTS := $(filter $(BUILD)/tests/test_viewer_% $(BUILD)/tests/fuzz/fuzz_viewer_%,$(UNIT) $(FUZZ))
$(VIEWER_TESTS): $(VIEWER_PARTS)
VIEWER_TESTS_O := $(patsubst %.c,$(BUILD)/%.o,$(wildcard tests/viewer/test_*.c tests/fuzz/fuzz_viewer_*.c))
$(VIEWER_TESTS_O): $(BUILD)/viewer/skeleton.h
$(VIEWER_TESTS_O): private CPPFLAGS += -Iviewer -I$(BUILD)/viewer

$(BUILD)/tests/fuzz/fuzz_edit: $(addprefix $(BUILD)/tools/himc/,edit_text.o cli.o file.o)
$(BUILD)/tests/test_osc_stranger: private LIBS += -Wl,--wrap=himc_osc_address_loopback
$(BUILD)/tests/fuzz/fuzz_edit: private LIBS += -Wl,--wrap=himc_system_open -Wl,--wrap=himc_system_open_inside
$(BUILD)/tests/fuzz/fuzz_log: $(addprefix $(BUILD)/tools/himc/,evaluate_log.o trial.o) $(MOCAP_O)

# Debian has no package of Unity's own; the source package cjson carries it
build/unity/src/unity.c:
	@echo "get  $@"
	$(Q)tools/build/unity.sh build/unity

$(EXTERNALS) &: $(wildcard pd-externals/* lib/himc/*.h) $(LIBRARY)
	@echo "pd   $(EXTERNALS)"
	$(call make_externals,$(BUILD)/externals)

$(EXTERNALS_64) &: $(wildcard pd-externals/* lib/himc/*.h) $(LIBRARY)
	@echo "pd   $(EXTERNALS_64)"
	$(call make_externals,$(BUILD)/externals-64 extension=linux-amd64-64.so FLOATSIZE=64)

$(EXTERNALS_MULTI) &: $(wildcard pd-externals/* lib/himc/*.h) $(LIBRARY)
	@echo "pd   $(EXTERNALS_MULTI)"
	$(call make_externals,$(BUILD)/externals-multi INSTANCES=1)
	@! nm -D --undefined-only $(EXTERNALS) | grep ' himc_' || { echo "$(@D): lacks the above; Pd would not load it" >&2; false; }

include tools/research/figures/figures.mk
check-figures: $(FIGURES)

-include $(wildcard $(BUILD)/tools/*/*.d $(BUILD)/tools/*/*/*.d) $(LIB_O:.o=.d) $(MOCAP_O:.o=.d) \
         $(UNIT_C:%.c=$(BUILD)/%.d) $(addsuffix .d,$(LONG) $(FUZZ) $(BUILD)/tests/fuzz/driver $(REALTIME))
