/// law.c: the table of the laws.
#include "control/law.h"

const himc_law_row himc_laws[HIMC_LAWS] = {
    [HIMC_LAW_PRINTED] = {"printed", himc_law_printed, false},
    [HIMC_LAW_FEEDFORWARD] = {"feedforward", himc_law_feedforward, false},
    [HIMC_LAW_COMPUTED_TORQUE] = {"computed-torque", himc_law_computed_torque, true},
};
