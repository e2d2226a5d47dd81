# figures.mk: the documentation's pictures and sounds, each from the program or score it shows. Included by the Makefile;
# `make figures` installs what they need and makes those that are older than what they are made of.
#
# A new one is a file in FIGURES and a rule for it. Programs in tools/figures/ are built by the rule for tools/*/*.c.
SOUNDS  := $(patsubst %,docs/sounds/%.ogg,scale roll glissando mallets)
FIGURES := docs/figures/timbre.svg docs/figures/spectrograms.png docs/figures/improvisation.png $(SOUNDS) \
           docs/sounds/improvisation.ogg

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
