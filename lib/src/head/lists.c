/// lists.c: instruments as lists of modes (list.c says what the lines mean). "Recorded" are single
/// strokes of free collections of samples, whose mallets, rooms and makers are not known.
#include "head/lists.h"

const himc_listed himc_lists[] = {
    // A rod of rosewood, 200 x 25 mm (chosen): a free Timoshenko beam (Timoshenko 1921), tuned to
    // the strongest partial of a recorded pair, 2160 Hz, which rang for T60 = .06 s; losses as of
    // a constant loss factor. The other clave strikes it.
    {"claves", "mallet 1e9 1.5 0.1\n"
               "surface clave bar 0.2 0.025\n"
               "pressure 0.00022\n"
               "mode 2160 0.06 0.03151 -1 -0.472 0.0858 0.511 0.671 0.511 0.0858 -0.472 -1\n"
               "pressure 0.00022\n"
               "mode 4458.3 0.0291 0.04032 1 0.113 -0.689 -0.716 0 0.716 0.689 -0.113 -1\n"
               "pressure 0.00019\n"
               "mode 6636.7 0.0195 0.04844 -1 0.22 0.829 -0.143 -0.938 -0.143 0.829 0.22 -1\n"
               "pressure 0.00018\n"
               "mode 8503.8 0.0152 0.05711 1 -0.548 -0.473 0.918 0 -0.918 0.473 0.548 -1\n"},
    // Recorded blocks have a tone of 700 to 760 Hz and one of 4680 Hz, and ring for .15 s and
    // more; what sounds is the slit under the struck tongue, a source of 10 x 6 cm (chosen, as
    // masses and rubber are).
    {"wood-block", "mallet 3e9 2 0.02\n"
                   "surface block bar 0.18 0.06\n"
                   "pressure 4e-4\n"
                   "mode 730 0.15 0.06 0.4 0.9 1 0.9 0.4\n"
                   "mode 4680 0.06 0.06 -0.6 0.3 1 0.3 -0.6\n"},
    // Five from left to right. Recorded: 540, 613, 690 and 903 Hz, T60 .15 to .5 s; between them
    // 789 Hz in the same steps. A hollow sphere with a slit has little more than one tone. Masses,
    // rubber: chosen.
    {"temple-blocks", "mallet 4e8 2 0.03\n"
                      "surface low bar 0.12 0.08\n"
                      "place 0 0.2\n"
                      "pressure 5e-4\n"
                      "mode 540 0.35 0.08 0.5 0.9 1 0.9 0.5\n"
                      "surface second bar 0.12 0.08\n"
                      "place 0 0.1\n"
                      "pressure 5e-4\n"
                      "mode 613 0.308 0.08 0.5 0.9 1 0.9 0.5\n"
                      "surface third bar 0.12 0.08\n"
                      "place 0 0\n"
                      "pressure 5e-4\n"
                      "mode 690 0.274 0.08 0.5 0.9 1 0.9 0.5\n"
                      "surface fourth bar 0.12 0.08\n"
                      "place 0 -0.1\n"
                      "pressure 5e-4\n"
                      "mode 789 0.24 0.08 0.5 0.9 1 0.9 0.5\n"
                      "surface high bar 0.12 0.08\n"
                      "place 0 -0.2\n"
                      "pressure 5e-4\n"
                      "mode 903 0.209 0.08 0.5 0.9 1 0.9 0.5\n"},
    // A rod of steel, 520 x 9 mm, as if it were straight: a free Timoshenko beam. Recorded ones
    // ring for 1 to 3 s up to 6 kHz, .7 to 2 s at 11 kHz. The side at the bottom is struck around
    // its middle, where a sixth of the rod is; as wide as a beater finds it.
    {"triangle", "mallet 1e9 1.5 0.05\n"
                 "surface side bar 0.083 0.03\n"
                 "pressure 9.5e-08\n"
                 "mode 149.4 2.89 0.06501 -0.552 -0.594 -0.608 -0.594 -0.552\n"
                 "pressure 5e-07\n"
                 "mode 410.97 2.72 0.0652 -0.403 -0.213 0 0.213 0.403\n"
                 "pressure 1.6e-06\n"
                 "mode 803.15 2.5 0.06547 -0.458 -0.646 -0.714 -0.646 -0.458\n"
                 "pressure 5.2e-06\n"
                 "mode 1322.1 2.25 0.06584 0.644 0.381 0 -0.381 -0.644\n"
                 "pressure 1.2e-05\n"
                 "mode 1964.7 2.01 0.0663 -0.133 -0.548 -0.713 -0.548 -0.133\n"
                 "pressure 1.5e-05\n"
                 "mode 2726.9 1.78 0.06685 0.712 0.52 0 -0.52 -0.712\n"
                 "pressure 1.6e-05\n"
                 "mode 3604.3 1.58 0.06749 -0.222 0.42 0.718 0.42 -0.222\n"
                 "pressure 1.6e-05\n"
                 "mode 4591.7 1.4 0.06822 -0.606 -0.629 0 0.629 0.606\n"
                 "pressure 2.2e-05\n"
                 "mode 5683.6 1.24 0.06903 -0.526 0.264 0.724 0.264 -0.526\n"
                 "pressure 2.3e-05\n"
                 "mode 6874 1.1 0.06992 -0.348 -0.7 0 0.7 0.348\n"
                 "pressure 7.8e-06\n"
                 "mode 8156.8 0.987 0.07089 -0.704 0.0901 0.731 0.0901 -0.704\n"
                 "pressure 8.7e-06\n"
                 "mode 9525.3 0.887 0.07193 0.00121 -0.728 0 0.728 -0.00121\n"
                 "pressure 1.1e-05\n"
                 "mode 10973 0.801 0.07305 -0.71 -0.0926 0.739 -0.0926 -0.71\n"
                 "pressure 2.3e-05\n"
                 "mode 12494 0.728 0.07425 0.356 -0.71 0 0.71 -0.356\n"
                 "pressure 3e-05\n"
                 "mode 14081 0.664 0.07551 0.539 0.272 -0.748 0.272 0.539\n"},
    // Two bells of sheet steel, left the low one; frequencies, losses and masses are chosen, as no
    // measured ones are known here: a fifth apart, each with partials as of a shell, 1 : 1.8 : 2.9
    // : 4.1.
    {"agogo", "mallet 3e8 1.5 0.03\n"
              "surface low bar 0.12 0.08\n"
              "place 0 0.06\n"
              "pressure 0.0002\n"
              "mode 700 0.5 0.06 0.3 0.7 1\n"
              "pressure 0.0002\n"
              "mode 1260 0.4 0.06 -0.3 0.4 1\n"
              "pressure 0.0002\n"
              "mode 2030 0.3 0.06 0.6 -0.5 1\n"
              "pressure 0.0002\n"
              "mode 2870 0.2 0.06 -0.7 0.2 1\n"
              "surface high bar 0.12 0.08\n"
              "place 0 -0.06\n"
              "pressure 0.0002\n"
              "mode 1050 0.5 0.06 0.3 0.7 1\n"
              "pressure 0.0002\n"
              "mode 1890 0.4 0.06 -0.3 0.4 1\n"
              "pressure 0.0002\n"
              "mode 3045 0.3 0.06 0.6 -0.5 1\n"
              "pressure 0.0002\n"
              "mode 4305 0.2 0.06 -0.7 0.2 1\n"},
    // Its two strongest tones as of a well known electronic one, 540 and 800 Hz (Werner, Abel &
    // Smith 2014); partials above, losses and masses: chosen.
    {"cowbell", "mallet 3e8 1.5 0.03\n"
                "surface bell bar 0.16 0.1\n"
                "pressure 0.00054\n"
                "mode 540 0.35 0.12 0.3 0.7 1\n"
                "pressure 0.00054\n"
                "mode 800 0.3 0.12 0.2 0.6 1\n"
                "pressure 0.00036\n"
                "mode 1370 0.2 0.1 -0.5 0.2 1\n"
                "pressure 0.00036\n"
                "mode 2110 0.15 0.1 0.6 -0.5 1\n"
                "pressure 0.00027\n"
                "mode 3340 0.1 0.1 -0.7 0.3 1\n"},
    {0},
};
