// SPDX-License-Identifier: MIT
// The smallest host: it owns main and includes one header.
#include <cstdio>
#include <vadose/vadose.hpp>

int main() {
  std::printf("vadose %d.%d.%d\n", VADOSE_VERSION_MAJOR, VADOSE_VERSION_MINOR,
              VADOSE_VERSION_PATCH);
  return vadose::is_finite(vadose::degrees(90.0)) ? 0 : 1;
}
