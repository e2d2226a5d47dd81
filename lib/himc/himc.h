/// himc.h: the whole of libhimc, in the order in which a stroke becomes sound.
///
///     score ┐
///     take ─┴→ planner, track → task → controller (ik → invdyn) → character (ODE)
///                                                                     ⇅
///     samples ←──────────────────────────── drum (membrane ⇄ contact) ┘
///     command (Pd, OSC, file) → performance: the clock of it all → osc: what others see of it
///
/// Beside the way: player finds in a take whose body it is, habit how that player's arms go with
/// the sticks, limits how far the joints turn; reach finds a posture for tips anywhere.
///
/// A percussionist of 20 segments and 57 degrees of freedom is driven, from nothing but the
/// trajectories of its two drumstick tips, by Hybrid Inverse Motion Control (Bouënard, Gibet and
/// Wanderley, The Visual Computer 28(4), 2012) inside every physics step; sticks and drumheads
/// exchange forces sample by sample. To play, make a himc_performance, give it commands and ask it
/// for samples; the headers below are its parts, each usable alone.
#ifndef HIMC_H
#define HIMC_H

#define HIMC_VERSION "0.1.0"

// what everything shares
#include "himc/base.h"
#include "himc/vec.h"
#include "himc/quintic.h"

// the body
#include "himc/skeleton.h"
#include "himc/pose.h"
#include "himc/limits.h"
#include "himc/reach.h"

// what to play: written or captured
#include "himc/command.h"
#include "himc/score.h"
#include "himc/take.h"
#include "himc/recording.h"
#include "himc/units.h"
#include "himc/planner.h"
#include "himc/posture.h"
#include "himc/player.h"
#include "himc/track.h"

// how the body is made to do it: algorithm 2
#include "himc/habit.h"
#include "himc/ik.h"
#include "himc/invdyn.h"
#include "himc/controller.h"
#include "himc/task.h"
#include "himc/character.h"

// what is struck
#include "himc/grid.h"
#include "himc/modes.h"
#include "himc/air.h"
#include "himc/bank.h"
#include "himc/membrane.h"
#include "himc/contact.h"
#include "himc/drum.h"

// all of it together
#include "himc/performance.h"
#include "himc/osc.h"

#endif
