/// himc.h: a virtual timpanist: the core of libhimc, all that a program needs to play.
///
///     score ┐
///     take ─┴→ planner → controller (inverse kinematics → inverse dynamics) → character (body)
///                                                                               ⇅
///     samples ←───────────────────────────────── drum (membrane ⇄ contact) ─────┘
///     command (Pd, OSC, file) → performance: the sample clock and the physics step → osc
///
/// A percussionist of 20 rigid segments and 57 degrees of freedom is driven, from the trajectories
/// of its two drumstick tips alone, by Hybrid Inverse Motion Control (Bouënard, Gibet and
/// Wanderley, The Visual Computer 28(4), 2012) inside every physics step. Sticks and drumheads
/// exchange forces sample by sample. To play: make a himc_performance and a himc_drum, send
/// commands, ask for samples.
///
/// Beside the core there is a second tier, one header for each concept, included where needed:
///
///     himc/vec.h        vectors, quaternions, rotation matrices
///     himc/body.h       skeleton, pose, joint limits, inverse kinematics, dynamics
///     himc/mocap.h      takes (BVH, C3D, TRC), the player in them, recordings
///     himc/membrane.h   drumhead, pickups, contact
///     himc/drive.h      joints driven from outside: rotations or torques
///     himc/loader.h     commands that take long, without holding up the sound
///     himc/osc.h        commands in and poses, strikes, states out over the network
///
/// Two further headers are tables: himc/command_rows.h, a row for each command, and himc/ranges.h,
/// the ranges that structs share with commands.
///
/// docs/api.md states what each tier promises. The sources in lib/src stand in rooms, a folder
/// each, in the order of the data flow (docs/overview.md):
///
///     system       what operating systems do differently: sockets, names of files, threads
///     base         errors, files, vectors, the table and the parser of commands
///     body         skeleton, pose, joint limits, dynamics; what moves a hand (a source)
///     capture      motion captures and the player in them
///     track        a source: the trajectories of the drumstick tips, from a take
///     plan         a source: the same from a score, hits and live targets
///     midi         a score made of a MIDI file
///     musicxml     the same of a MusicXML file; scores written as MusicXML and MIDI
///     control      inverse kinematics and inverse dynamics
///     bank         many damped oscillators
///     head         kinds of instrument, a file each: modes, air and kettle, uneven lugs, pickups
///     drum         a constant model, the membrane that moves, contact, stroke noise, ears, the air
///                  between drums
///     performance  performer and drums under one sample clock
///     osc          the network
#ifndef HIMC_H
#define HIMC_H

#include "himc/base.h"
#include "himc/command.h"
#include "himc/score.h"
#include "himc/drum.h"
#include "himc/performance.h"

#endif
