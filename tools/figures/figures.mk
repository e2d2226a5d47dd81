# figures.mk: the documentation's pictures and sounds, each from the program or score it shows. Included by the Makefile;
# `make figures` installs what they need and makes those that are older than what they are made of.
#
# A new one is a file in FIGURES and a rule for it. Programs in tools/figures/ are built by the rule for tools/*/*.c.
# both NAME: a curve as it is for the page and for print
both     = docs/figures/$(1).svg docs/figures/$(1).png
SOUNDS  := $(patsubst %,docs/sounds/%.ogg,scale roll glissando mallets)
MOTION  := $(foreach name,strokes strokes-default phases legato-accent evaluation claim measures,$(call both,$(name)))
FIGURES := docs/figures/timbre.svg docs/figures/spectrograms.png docs/figures/improvisation.png $(SOUNDS) \
           docs/sounds/improvisation.ogg $(MOTION) $(BUILD)/figures/database.txt

# trials of each row of the evaluation, and of each point of the claim's dependences; 100 take two cores two hours, 9 ten
# minutes: make figures TRIALS=9
TRIALS ?= 100
CLAIM  ?= 3
MEASURES ?= 3

docs/figures/timbre.svg: $(BUILD)/tools/figures/timbre tools/figures/timbre.gp
	@mkdir -p $(BUILD)/figures && echo "draw $@"
	$(Q)$< >$(BUILD)/figures/timbre.txt
	$(Q)gnuplot -e "data='$(BUILD)/figures/timbre.txt'; out='$@'" tools/figures/timbre.gp
	$(Q)sed -i 's/[[:blank:]]*$$//; s/\t/  /g' $@

$(SOUNDS) &: $(BUILD)/tools/figures/sounds
	@echo "play $(SOUNDS)"
	$(Q)$< docs/sounds

docs/figures/spectrograms.png: $(BUILD)/tools/figures/spectrogram tools/figures/spectrograms.gp $(SOUNDS)
	@mkdir -p $(BUILD)/figures && echo "draw $@"
	$(Q)for s in scale roll glissando mallets; do $< docs/sounds/$$s.ogg >$(BUILD)/figures/$$s.txt || exit 1; done
	$(Q)gnuplot -e "folder='$(BUILD)/figures'; out='$@'" tools/figures/spectrograms.gp

# what make demo leaves: Pd's own sound, and its picture
$(BUILD)/demo/improvisation.wav: patches/improvisation.txt patches/01-improvisation.pd $(PROGRAM) $(EXTERNALS)
	$(Q)HIMC_BUILD=$(BUILD) tools/demo.sh

docs/figures/improvisation.png: $(BUILD)/demo/improvisation.wav
	@echo "copy $@"
	$(Q)cp $(BUILD)/demo/improvisation.png $@

docs/sounds/improvisation.ogg: $(BUILD)/demo/improvisation.wav
	@echo "play $@"
	$(Q)sox $< -C 2 $@

# the papers' figures; a curve is drawn twice, as SVG and as PNG. Gains are said over those of a player's own stiffness, a
# third of the default ones.
FOLLOW := $(BUILD)/tools/figures/strokes
CURVES := $(BUILD)/figures
STYLE  := tools/figures/style.gp

# draw SCRIPT NAME SETTINGS; the line below the title is SAID
define draw
	@echo "draw docs/figures/$(2)"
	$(Q)for kind in svg png; do \
	    gnuplot -e "kind='$$kind'; out='docs/figures/$(2).$$kind'; said='$(SAID)'; $(3)" tools/figures/$(1).gp || exit 1; \
	done
	$(Q)sed -i 's/[[:blank:]]*$$//; s/\t/  /g' docs/figures/$(2).svg
endef

$(CURVES)/printed.txt: $(FOLLOW)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< follow printed 0.333333 >$@

$(CURVES)/default.txt: $(FOLLOW)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< follow computed-torque 1 >$@

$(CURVES)/phases.txt: $(FOLLOW)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< phases printed 0.333333 >$@

$(CURVES)/rates.txt: $(BUILD)/tools/figures/claim
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< rates $(CLAIM) >$@

$(CURVES)/measures.txt: $(BUILD)/tools/figures/claim
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< measures $(MEASURES) >$@

$(CURVES)/nuances.txt: $(BUILD)/tools/figures/claim
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< nuances $(TRIALS) >$@

$(CURVES)/beats.txt: tools/figures/score.awk tools/figures/legato-accent.txt
	@mkdir -p $(@D)
	$(Q)awk -f $^ >$@

$(CURVES)/legato-accent.csv: tools/figures/legato-accent.txt $(PROGRAM)
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$(PROGRAM) render $< -o $(CURVES)/legato-accent.wav --motion $@ >/dev/null

# trials already in the log are not done again, but for those of a program that was another
docs/figures/evaluation.csv: $(PROGRAM)
	@echo "play $@"
	$(Q)test $(BUILD)/evaluation-trials.csv -nt $(PROGRAM) || rm -f $(BUILD)/evaluation-trials.csv
	$(Q)$(PROGRAM) evaluate --trials $(TRIALS) --log $(BUILD)/evaluation-trials.csv --csv $@

$(call both,strokes): SAID := legato, right side; printed law, gain × 1, joint limits on
$(call both,strokes) &: $(CURVES)/printed.txt tools/figures/follow.gp $(STYLE)
	$(call draw,follow,strokes,data='$<'; from=2.2; to=5)

$(call both,strokes-default): SAID := legato, right side; computed torque, gain × 3, as himc plays by default
$(call both,strokes-default) &: $(CURVES)/default.txt tools/figures/follow.gp $(STYLE)
	$(call draw,follow,strokes-default,data='$<'; from=2.2; to=5)

$(call both,phases): SAID := right hand; printed law, gain × 1, joint limits on
$(call both,phases) &: $(CURVES)/phases.txt tools/figures/phases.gp $(STYLE)
	$(call draw,phases,phases,data='$<'; from=2; to=4.6)

$(call both,legato-accent) &: $(CURVES)/beats.txt $(CURVES)/legato-accent.csv tools/figures/score.gp $(STYLE)
	$(call draw,score,legato-accent,beats='$<'; motion='$(word 2,$^)')

$(call both,claim): SAID := printed law, legato made slower and faster; mean and deviation of $(CLAIM) players
$(call both,claim) &: $(CURVES)/rates.txt tools/figures/claim.gp $(STYLE)
	$(call draw,claim,claim,data='$<')

$(call both,measures): SAID := legato, joint limits on; mean and deviation of $(MEASURES) players
$(call both,measures) &: $(CURVES)/measures.txt tools/figures/measures.gp $(STYLE)
	$(call draw,measures,measures,data='$<')

$(CURVES)/spread.txt: docs/figures/evaluation.csv tools/figures/spread.awk
	@mkdir -p $(@D)
	$(Q)awk -f tools/figures/spread.awk $(BUILD)/evaluation-trials.csv >$@

$(call both,evaluation): SAID := $(TRIALS) trials of each nuance; joint limits on
$(call both,evaluation) &: $(CURVES)/nuances.txt $(CURVES)/spread.txt tools/figures/evaluation.gp $(STYLE)
	$(call draw,evaluation,evaluation,gentle='$<'; table='$(word 2,$^)')

# the table of the undisturbed database in docs/evaluation.md
$(CURVES)/database.txt: $(BUILD)/tools/figures/database
	@mkdir -p $(@D) && echo "play $@"
	$(Q)$< >$@
