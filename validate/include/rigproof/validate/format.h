// Validation as people read it on a terminal. Everything is returned as text that ends with a newline.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/budget.h"
#include "rigproof/validate/explanation.h"
#include "rigproof/validate/proof.h"
#include "rigproof/validate/validate.h"

namespace rigproof {

/// One row a camera: error, and the stated sigma where there is one, in cm and deg, columns aligned. With a gate, the
/// failing axes of a camera stand at its end. Then a line on what the cameras share, and cameras without an answer.
/// Reasons are codes unless somebody words them.
std::string format_errors(const Comparison& comparison, const Gate* gate = nullptr, const Wording& wording = {});

/// "PASS  36/36 within 4 sigma; sigmas honest: NEES 16.9 (95 %: 8.2-31.5)", or what failed and the one cause.
std::string format_verdict(const Comparison& comparison, const Gate& gate, const Budget& budget,
                           const Wording& wording = {});

/// If one axis of one camera is to blame, the results of other methods on the same data: "The data allow 0.003 cm (1
/// sigma of ml). Same run: ml +.003, joint_memroc +.012." Empty if nothing or nobody compares. `same_run` may hold
/// `comparison` too, which is left out by its method's name.
std::string format_same_run(const Comparison& comparison, const Budget& budget,
                            const std::vector<Comparison>& same_run);

/// "sigmas honest: NEES 16.9 (95 %: 8.2-31.5)" without a newline; empty where no covariance was stated.
std::string format_nees(const Comparison& comparison);

/// Whether format_nees() says so: NEES of all cameras, or else of one of them, lies above the 95 % interval.
bool are_sigmas_too_small(const Comparison& comparison);

/// "CONVENTION  matches the truth only when inverted ..", with the errors now and then: empty without a suspicion.
std::string format_suspicion(const Comparison& comparison, const Wording& wording = {});

/// The whole answer: errors, suspicion, verdict. `subject` is what the user named, e.g. "theirs.yaml".
std::string format_validation(const Comparison& comparison, const Gate& gate, const Budget& budget,
                              const std::string& subject, const Wording& wording = {});

/// The run's mean absolute errors beside the published rows, with the paper's roll-pitch-yaw reading of rotations.
std::string format_paper(const Comparison& comparison);

/// One row a camera: bias, rms and largest residual of corners and depth; then the problems.
std::string format_proof(const Proof& proof, const Wording& wording = {});

}  // namespace rigproof
