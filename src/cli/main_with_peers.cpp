// SPDX-License-Identifier: Apache-2.0
// controlspace-peers: the same commands, with the rows of foreign systems.
#include "baselines/add_structures.h"
#include "baselines/peers/peer_rows.h"
#include "cli/program.h"

int main(int argc, char** argv) {
    controlspace::add_structures(controlspace::peer_rows());
    return controlspace::run_program(argc, argv);
}
