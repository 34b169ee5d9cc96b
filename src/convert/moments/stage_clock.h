// stage_clock.h: wall time and progress of the stages of a conversion.
#pragma once

#include <chrono>

#include "vog/convert_moments.h"
#include "vog/progress.h"

namespace vog::moments {

/// Stopwatch from construction on, shared by the conversions of volumes and of particles.
class StageClock {
  public:
    /// Both outlive the clock.
    StageClock(MomentReport& report, const Progress& progress)
        : report_(report), progress_(progress) {}

    /// Appends the milliseconds since the last stage ended to MomentReport::stage_ms.
    /// fraction  of the whole conversion that is done, [0, 1]
    void end_stage(const char* name, double fraction) {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
        report_.stage_ms.emplace_back(name, ms);
        last_ = now;
        if (progress_) progress_(fraction);
    }

  private:
    MomentReport& report_;
    const Progress& progress_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace vog::moments
