// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/exchanged_sessions.hpp"
#include "elastocal/observation/touches_in_the_air.hpp"
#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Text such as "5 of 40 touches seem to be none: by the others, the plate stood 5.9 to 39 mm above
/// its table in left.csv:7, 12".
std::string DescribeTouchesInTheAir(const ObservedRobot& model, const Observations& observations,
                                    const std::vector<TouchInTheAir>& air);

/// What is left without touches in the air.
struct TouchesLeftOut {
  Observations others;
  std::string text;   ///< DescribeTouchesInTheAir
  bool many = false;  ///< more than a quarter of the touches of a plate were in the air
};

/// Leaves out touches in the air (FindTouchesInTheAir); nothing where there are none.
std::optional<TouchesLeftOut> WithoutTouchesInTheAir(const ObservedRobot& model,
                                                     const Observations& observations);

/// Removes touches in the air (WithoutTouchesInTheAir) from the observations, and returns whether
/// there were any. A few of them give a warning. More than a quarter of a plate's touches give the
/// objection `wrong_rows`, as with outliers: too few are left to tell which are right.
bool LeaveOutTouchesInTheAir(ContactRun& run);

/// Text such as "3 of 40 rows seem to be of another session (contact.sessions, or the file) than
/// they say: ...".
std::string DescribeOtherSessions(const std::vector<OtherSession>& found,
                                  const Observations& observations);

/// Assigns rows to the session to which they belong instead of the stated one
/// (FindExchangedSessions), and returns whether there were any. `wrong_rows` is then the objection
/// that names them.
bool ExchangeSessions(ContactRun& run);

}  // namespace elastocal
