// Loops of the generated ticks over rows of nine numbers of a setpoint and twelve of the motors.

#include <cstddef>

#include "links.h"
#include "massless.h"

extern "C" void symforce_massless(const MasslessSetpoint* setpoints, std::size_t count,
                                  const MasslessCoefficients* coefficients, Scalar* motors) {
  for (std::size_t i = 0; i < count; ++i) massless(setpoints[i], *coefficients, motors + 12 * i);
}

extern "C" void symforce_links(const LinksSetpoint* setpoints, std::size_t count,
                               const LinksCoefficients* coefficients, Scalar* motors) {
  for (std::size_t i = 0; i < count; ++i) links(setpoints[i], *coefficients, motors + 12 * i);
}
