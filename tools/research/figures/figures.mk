# figures.mk: the pictures and sounds of the documentation, each from the program, score or table that it shows. Included by
# the Makefile.
#
# `make figures` installs what they need and makes what is out of date, in build/figures and build/sounds, in less than a
# minute. It reads the results of the trials, docs/figures/*.csv; only `make trials` writes these, in 90 minutes of processor time.
# Five files are committed, because README.md and docs/ show them: docs/figures/evaluation.png and improvisation.png and
# docs/sounds/improvisation.ogg are copies of what `make figures` makes, docs/figures/viewer-stage.png of what `make still`
# makes, docs/figures/panel.png is a picture of Pd's window.
#
# A new picture is a name in CURVES and a rule for it. Programs in tools/research/figures/ are built by the rule for tools/*/*.c.
# KIND=svg draws for print.
KIND   ?= png
DRAWN  := $(BUILD)/figures
CURVES := strokes strokes-default elbow tip phases blows legato-accent evaluation claim measures timbre
PLAYED := $(patsubst %,$(BUILD)/sounds/%.ogg,scale roll glissando mallets)
FIGURES := $(patsubst %,$(DRAWN)/%.$(KIND),$(CURVES)) $(DRAWN)/spectrograms.png $(DRAWN)/improvisation.png \
           $(PLAYED) $(BUILD)/sounds/improvisation.ogg
STYLE  := tools/research/figures/style.gp
RESULTS := docs/figures

# draw SCRIPT SETTINGS; SAID is the line below the title
define draw
	@mkdir -p $(@D) && echo "draw $@"
	$(Q)gnuplot -e "kind='$(KIND)'; out='$@'; $(2)" tools/research/figures/$(1).gp
endef

# play PROGRAM ARGUMENTS
define play
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$(1) >$@
endef

# from the results of trials
$(DRAWN)/evaluation.$(KIND): $(RESULTS)/spread.csv tools/research/figures/evaluation.gp $(STYLE)
	$(call draw,evaluation,data='$<')

$(DRAWN)/claim.$(KIND): $(RESULTS)/claim.csv tools/research/figures/claim.gp $(STYLE)
	$(call draw,claim,data='$<')

$(DRAWN)/measures.$(KIND): $(RESULTS)/measures.csv tools/research/figures/measures.gp $(STYLE)
	$(call draw,measures,data='$<')

$(DRAWN)/strokes.$(KIND): SAID := legato, right side; printed law, gain × 1, joint limits on
$(DRAWN)/strokes.$(KIND): $(RESULTS)/strokes.csv tools/research/figures/follow.gp $(STYLE)
	$(call draw,follow,data='$<'; said='$(SAID)')

$(DRAWN)/strokes-default.$(KIND): SAID := legato, right side; computed torque, gain × 3, the default
$(DRAWN)/strokes-default.$(KIND): $(RESULTS)/strokes-default.csv tools/research/figures/follow.gp $(STYLE)
	$(call draw,follow,data='$<'; said='$(SAID)')

$(DRAWN)/phases.$(KIND): SAID := right hand; printed law, gain × 1, joint limits on
$(DRAWN)/phases.$(KIND): $(RESULTS)/phases.csv tools/research/figures/phases.gp $(STYLE)
	$(call draw,phases,data='$<'; said='$(SAID)')

$(DRAWN)/elbow.$(KIND): SAID := legato, right arm; IK: damped least squares, 40 steps a frame
$(DRAWN)/elbow.$(KIND): $(RESULTS)/strokes.csv tools/research/figures/curves.gp $(STYLE)
	$(call draw,curves,data='$<'; said='$(SAID)'; title='Flexion of the elbow'; axis='elbow flexion (°)'; quantity='elbow_deg'; motions='captured reach')

$(DRAWN)/tip.$(KIND): SAID := legato, right hand; printed law, gain × 1, joint limits on
$(DRAWN)/tip.$(KIND): $(RESULTS)/strokes.csv tools/research/figures/curves.gp $(STYLE)
	$(call draw,curves,data='$<'; said='$(SAID)'; title='Height of the drumstick'; axis='height of the tip (cm)'; quantity='tip_cm'; motions='captured id himc')

# a score
$(DRAWN)/beats.txt: tools/research/figures/score.awk tools/research/figures/legato-accent.txt
	$(call play,awk -f $^)

$(DRAWN)/legato-accent.csv: tools/research/figures/legato-accent.txt $(PROGRAM)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$(PROGRAM) render $< -o $(DRAWN)/legato-accent.wav --motion $@ >/dev/null

$(DRAWN)/legato-accent.$(KIND): $(DRAWN)/beats.txt $(DRAWN)/legato-accent.csv tools/research/figures/score.gp $(STYLE)
	$(call draw,score,beats='$<'; motion='$(word 2,$^)')

$(DRAWN)/blows.csv: tools/research/figures/blows.txt $(PROGRAM)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$(PROGRAM) render $< --channels 1 -o $(DRAWN)/blows.wav --strokes $@ --quiet >/dev/null

$(DRAWN)/blows.$(KIND): $(DRAWN)/blows.csv tools/research/figures/blows.gp $(STYLE)
	$(call draw,blows,strokes='$<'; sound='$(DRAWN)/blows.wav')

# the drum alone
$(DRAWN)/timbre.txt: $(BUILD)/tools/research/figures/timbre
	$(call play,$<)

$(DRAWN)/timbre.$(KIND): $(DRAWN)/timbre.txt tools/research/figures/timbre.gp $(STYLE)
	$(call draw,timbre,data='$<')

$(PLAYED) &: $(BUILD)/tools/research/figures/sounds
	@mkdir -p $(BUILD)/sounds && echo "play $(PLAYED)"
	$(Q)$< $(BUILD)/sounds

$(DRAWN)/spectrograms.png: $(BUILD)/tools/research/figures/spectrogram tools/research/figures/spectrograms.gp $(PLAYED)
	@mkdir -p $(@D) && echo "draw $@"
	$(Q)for s in $(PLAYED); do $< $$s >$(DRAWN)/$$(basename $$s .ogg).txt || exit 1; done
	$(Q)gnuplot -e "folder='$(DRAWN)'; out='$@'" tools/research/figures/spectrograms.gp

# sound and picture that make demo leaves; the sound is Pd's own
$(BUILD)/demo/improvisation.wav: patches/improvisation.txt patches/01-improvisation.pd $(PROGRAM) $(EXTERNALS)
	$(Q)HIMC_BUILD=$(BUILD) tools/build/demo.sh

$(DRAWN)/improvisation.png: $(BUILD)/demo/improvisation.wav
	@mkdir -p $(@D) && echo "copy $@"
	$(Q)cp $(BUILD)/demo/improvisation.png $@

$(BUILD)/sounds/improvisation.ogg: patches/improvisation.txt $(PROGRAM)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$(PROGRAM) render $< -o $@ --quiet >$(BUILD)/sounds/improvisation.log

# the trials: TRIALS of each row of the evaluation, RATES and LIMBS of each point of claim and measures
TRIALS ?= 100
RATES  ?= 3
LIMBS  ?= 3
CLAIM  := $(BUILD)/tools/research/figures/claim
TRIED  := $(BUILD)/trials

# trials that are in the log are not done again, unless the program has changed
$(TRIED)/evaluation.csv: $(PROGRAM)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)test $(TRIED)/log.csv -nt $(PROGRAM) || rm -f $(TRIED)/log.csv
	$(Q)$(PROGRAM) evaluate --trials $(TRIALS) --log $(TRIED)/log.csv --csv $@

$(TRIED)/nuances.csv: $(CLAIM)
	$(call play,$< nuances $(TRIALS))

$(TRIED)/spread.csv: $(TRIED)/nuances.csv $(TRIED)/evaluation.csv tools/research/figures/spread.awk
	$(call play,cat $<)
	$(Q)awk -v trials=$(TRIALS) -f tools/research/figures/spread.awk $(TRIED)/log.csv >>$@

$(TRIED)/claim.csv: $(CLAIM)
	$(call play,$< rates $(RATES))

$(TRIED)/measures.csv: $(CLAIM)
	$(call play,$< measures $(LIMBS))

# excerpts of single trials; gains are relative to the default ones, a player's are a third of them
STROKES := $(BUILD)/tools/research/figures/strokes
$(TRIED)/strokes.csv: $(STROKES)
	$(call play,$< follow printed 0.333333 2.2 5)

$(TRIED)/strokes-default.csv: $(STROKES)
	$(call play,$< follow computed-torque 1 2.2 5)

$(TRIED)/phases.csv: $(STROKES)
	$(call play,$< phases printed 0.333333 2 4.6)

# all 45 sequences undisturbed
$(TRIED)/database.csv: $(BUILD)/tools/research/figures/database
	$(call play,$<)

# of the trials above: strokes that land, by control; trial 1 of each row, which a test plays again
$(TRIED)/landed.csv: $(TRIED)/evaluation.csv tools/research/figures/landed.awk
	$(Q)awk -v trials=$(TRIALS) -f tools/research/figures/landed.awk $(TRIED)/log.csv >$@

$(TRIED)/first.csv: $(TRIED)/evaluation.csv
	$(Q)awk -F , 'FNR == 1; $$4 == 1 && !seen[$$0]++' $(TRIED)/log.csv >$@

# what a step and a trial cost on this machine
$(TRIED)/costs.csv: $(BUILD)/tools/research/papers/measure $(PROGRAM)
	$(call play,$< costs)
	$(Q)$(PROGRAM) bench --json --quiet | tr -d '{}" ' | tr ',:' '\n,' >>$@

# all tables at once, and the commit that they are of
TABLES := evaluation spread claim measures strokes strokes-default phases database landed first costs
check-trials: $(patsubst %,$(TRIED)/%.csv,$(TABLES))
	at=$$(git describe --always --dirty=' with changes' --abbrev=40 --exclude '*') && cp $^ $(RESULTS) && \
	    echo "commit $$at, $$(date -u +%F), trials: $$(awk -F , 'NR > 1 && !n[$$1, $$5]++ { printf "%sgain %s %s", c, $$1, $$5; c = ", " }' \
	        $(RESULTS)/spread.csv)" >$(RESULTS)/trials.txt
.PHONY: trials check-trials
