#include "rigproof/core/result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "pose_near.h"
#include "sample_data.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct ResultFile : TempFolder {
  Result load(const std::string& text) const {
    write("r.yaml", text);
    return load_result(*this / "r.yaml");
  }
  std::string problems(const std::string& text) const {
    return error_text([&] { load(text); });
  }
};

TEST(Result, RoundTripKeepsEveryValueAndEveryByte) {
  const TempFolder folder;
  const Result a = sample_result();
  save_result(a, folder / "a.yaml");
  const Result b = load_result(folder / "a.yaml");
  EXPECT_EQ(b.method, "ml");
  EXPECT_EQ(b.status, ResultStatus::kSolved);
  EXPECT_EQ(a.reasons, b.reasons);
  EXPECT_EQ(a.notes, b.notes);
  for (std::size_t i = 0; i < 2; ++i) {
    // The sign of the quaternion is free, its bits are not.
    EXPECT_TRUE(IsPoseNear(a.camera_to_robot[i].T_parent_child, b.camera_to_robot[i].T_parent_child, 0.0, 1e-15));
    EXPECT_EQ(a.camera_to_robot[i].covariance->triangularView<Eigen::Upper>().toDenseMatrix(),
              b.camera_to_robot[i].covariance->triangularView<Eigen::Upper>().toDenseMatrix());
  }
  EXPECT_FALSE(b.camera_to_camera[0].covariance);
  EXPECT_EQ(a.joint_covariance->triangularView<Eigen::Upper>().toDenseMatrix(),
            b.joint_covariance->triangularView<Eigen::Upper>().toDenseMatrix());
  EXPECT_EQ(b.use[0].left_out[0].why, Finding("board.cut_off"));
  EXPECT_EQ(b.residuals[1].rms, 1.01);
  ASSERT_EQ(b.also_estimated.size(), 2U);
  EXPECT_EQ(b.also_estimated[1].camera, "center");
  EXPECT_EQ(b.also_estimated[1].name, "clock_offset_ms");
  EXPECT_EQ(b.also_estimated[0].value, -0.31);
  EXPECT_EQ(b.also_estimated[0].sigma, 0.02);
  EXPECT_EQ(b.also_estimated[1].prior_sigma, 10.0);
  ASSERT_EQ(b.camera_to_robot[0].budget.size(), 2U);
  EXPECT_EQ(b.camera_to_robot[0].budget[1].source, "board");
  EXPECT_EQ(b.camera_to_robot[0].budget[1].share, a.camera_to_robot[0].budget[1].share);
  EXPECT_EQ(b.rotation_centre_m, a.rotation_centre_m);
  EXPECT_EQ(b.rotation_centre_sigma_m, a.rotation_centre_sigma_m);
  ASSERT_TRUE(b.lasting);
  ASSERT_EQ(b.lasting->unknowns.size(), 2U);
  EXPECT_EQ(b.lasting->unknowns[0].of.camera, "left");
  EXPECT_EQ(b.lasting->unknowns[1].of.board, 1);
  EXPECT_EQ(b.lasting->unknowns[1].name, "board_size_percent");
  EXPECT_EQ(b.lasting->unknowns[0].value, -0.31);
  EXPECT_EQ(b.lasting->covariance, a.lasting->covariance);
  EXPECT_EQ(b.lasting->with_cameras, a.lasting->with_cameras);
  ASSERT_EQ(b.lasting->fine_fields.size(), 1U);
  EXPECT_EQ(b.lasting->fine_fields[0].cells, 12);
  EXPECT_EQ(b.lasting->stated[1].hash, "fedcba9876543210");
  ASSERT_EQ(b.boards.size(), 1U);
  EXPECT_EQ(b.boards[0].number, 3);
  EXPECT_EQ(b.boards[0].T_first_board.translation, a.boards[0].T_first_board.translation);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(b.boards[0].sigma[i], a.boards[0].sigma[i], 1e-18) << i;
  ASSERT_EQ(b.lenses.size(), 1U);
  EXPECT_EQ(b.lenses[0].camera, "left");
  EXPECT_EQ(b.lenses[0].intrinsics.fx_px, 640.0);
  EXPECT_EQ(b.find("left", "center"), &b.camera_to_camera[0]);
  EXPECT_EQ(b.find("left", "right"), nullptr);
  save_result(b, folder / "b.yaml");
  EXPECT_EQ(folder.read("a.yaml"), folder.read("b.yaml"));
}

// Somebody who gives the wrong file is told what it is.
TEST(Result, ARigAndABagAreNamed) {
  const TempFolder folder;
  folder.write("rig.yaml",
               "name: cart\nrobot_frame: base\nboard: {squares: [5, 4]}\ncameras: {left: {folder: left}}\n");
  EXPECT_THAT(error_text([&] { load_result(folder / "rig.yaml"); }),
              AllOf(HasSubstr("rig.yaml: is a rig, not a result"), Not(HasSubstr("missing"))));
  folder.write("a.mcap", "\x89MCAP");
  EXPECT_THAT(error_text([&] { load_result(folder / "a.mcap"); }), HasSubstr("rigproof init"));
}

// Files of before, and what other programs write, hold sentences.
TEST(Result, SentencesAreFindingsThatSomebodyStated) {
  const ResultFile loader;
  const Result result = loader.load(
      "format: rigproof-result\nversion: 1\nmethod: old\nstatus: refused\nreasons: [\"left: too dark.\"]\n"
      "notes:\n  - 42\nuse:\n  - {camera: left, used: 0, left_out: [{stop: 3, file: a.png, reason: board cut off}, "
      "{stop: 4, file: b.png, reason: \"depth: too far\"}]}\n");
  EXPECT_EQ(result.reasons, std::vector<Finding>{stated("left: too dark.", Severity::kRefusal)});
  EXPECT_EQ(result.notes, std::vector<Finding>{stated("42", Severity::kNote)});
  ASSERT_EQ(result.use[0].left_out.size(), 2U);
  EXPECT_EQ(result.use[0].left_out[0].why, stated("board cut off", Severity::kLeftOut));
  EXPECT_FALSE(result.use[0].left_out[0].depth);
  EXPECT_EQ(result.use[0].left_out[1].why, stated("too far", Severity::kLeftOut));
  EXPECT_TRUE(result.use[0].left_out[1].depth);
}

// The sentence is for people: whatever it says, the code counts.
TEST(Result, SentencesOfFindingsAreWrittenAndNeverRead) {
  const TempFolder folder;
  const Result written = sample_result();
  save_result(written, folder / "a.yaml", [](const Finding& finding) { return "words of " + finding.code; });
  EXPECT_THAT(folder.read("a.yaml"),
              HasSubstr("  - sentence: words of odometry.unit\n    code: odometry.unit\n    severity: cause\n"));
  const Result read = load_result(folder / "a.yaml");
  EXPECT_EQ(read.reasons, written.reasons);
  EXPECT_EQ(read.notes, written.notes);
}

TEST(Result, BadFindingsAreNamed) {
  const ResultFile loader;
  const std::string head = "format: rigproof-result\nversion: 2\nstatus: refused\n";
  EXPECT_THAT(loader.problems(head + "reasons: [{severity: refusal}]\n"), HasSubstr("reasons[0].code: is missing"));
  EXPECT_THAT(loader.problems(head + "reasons: [{code: A b}]\n"), HasSubstr("must be the code of a finding"));
  EXPECT_THAT(loader.problems(head + "notes: [{code: a, severity: bad}]\n"), HasSubstr("notes[0].severity"));
  EXPECT_THAT(loader.problems(head + "notes: [{code: a, values: {x: [1]}}]\n"), HasSubstr("notes[0].values.x"));
  EXPECT_THAT(loader.problems(head + "notes: {code: a}\n"), HasSubstr("must be a list of findings"));
}

TEST(Result, IsReadable) {
  const TempFolder folder;
  save_result(sample_result(), folder / "a.yaml");
  const std::string text = folder.read("a.yaml");
  EXPECT_THAT(text, HasSubstr("  - sentence: pose of left in base_footprint\n    parent: base_footprint\n"
                              "    child: left\n    translation_m: ["));
  EXPECT_THAT(text, HasSubstr("    stddev: {tx_cm: "));
  EXPECT_THAT(text, Not(HasSubstr("solve_s"))) << "results are byte-identical across runs";
}

EstimatedTransform partial_transform(const Rigid3& T) {
  EstimatedTransform transform{"robot", "left", T, {}, {}};
  transform.observable = {false, false, true, true, true, false};
  return transform;
}

// Unknown degrees have no number on disk; what is known survives: height, roll, pitch and their covariance.
TEST(Result, UnobservableDegreesAreAbsent) {
  const TempFolder folder;
  Result result;
  result.method = "ml";
  result.status = ResultStatus::kPartial;
  RandomStream random(1, "partial");
  result.camera_to_robot = {partial_transform(random_transform(random))};
  result.camera_to_robot[0].covariance = random_covariance(random, 6, 1e-3);
  save_result(result, folder / "a.yaml");
  const std::string text = folder.read("a.yaml");
  EXPECT_THAT(text, HasSubstr("unobservable: [tx, ty, rz]"));
  EXPECT_THAT(text, HasSubstr("tz_m: "));
  for (const char* absent : {"tx_m", "ty_m", "yaw_rad", "translation_m", "quaternion", "tx_cm", "rz_deg"})
    EXPECT_THAT(text, Not(HasSubstr(absent)));
  const Result again = load_result(folder / "a.yaml");
  const EstimatedTransform& t = again.camera_to_robot.at(0);
  EXPECT_EQ(t.observable, result.camera_to_robot[0].observable);
  EXPECT_EQ(t.T_parent_child.translation.z(), result.camera_to_robot[0].T_parent_child.translation.z());
  EXPECT_EQ((*t.covariance)(2, 2), (*result.camera_to_robot[0].covariance)(2, 2));
  EXPECT_TRUE(std::isinf((*t.covariance)(0, 0)));
  save_result(again, folder / "b.yaml");
  EXPECT_EQ(text, folder.read("b.yaml"));
}

// What differs between the truth and the partial answer is a turn about the robot's z axis and nothing else.
TEST(Result, APartialAttitudeIsTheTrueOneUpToHeading) {
  const TempFolder folder;
  RandomStream random(2, "heading");
  for (int i = 0; i < 20; ++i) {
    Result result;
    result.status = ResultStatus::kPartial;
    const Rigid3 T = random_transform(random);
    result.camera_to_robot = {partial_transform(T)};
    save_result(result, folder / "a.yaml");
    const Rigid3 loaded = load_result(folder / "a.yaml").camera_to_robot[0].T_parent_child;
    const Eigen::Vector3d turn = so3_log(T.rotation * loaded.rotation.conjugate());
    EXPECT_LT(turn.head<2>().norm(), 1e-12) << turn.transpose();
  }
}

// The variance of a tilt about a fixed axis of the robot, whatever the heading: its covariance turns with the axes.
TEST(Result, APartialCovarianceIsInTheAxesOfZeroHeading) {
  const TempFolder folder;
  Result result;
  result.status = ResultStatus::kPartial;
  // A camera that looks along robot y: yaw 90 degrees. rx is then a pitch of the camera, ry a roll.
  Eigen::Matrix3d R;
  R << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  result.camera_to_robot = {partial_transform(Rigid3(Eigen::Quaterniond(R), {0.0, 0.0, 1.0}))};
  Vector6d variances;
  variances << 1.0, 1.0, 1e-6, 4e-6, 9e-6, 1.0;
  result.camera_to_robot[0].covariance = variances.asDiagonal();
  save_result(result, folder / "a.yaml");
  const Matrix6d c = *load_result(folder / "a.yaml").camera_to_robot[0].covariance;
  EXPECT_NEAR(c(3, 3), 9e-6, 1e-18);
  EXPECT_NEAR(c(4, 4), 4e-6, 1e-18);
}

TEST(Result, NothingObservableIsWrittenToo) {
  const TempFolder folder;
  Result result;
  result.status = ResultStatus::kRefused;
  result.camera_to_robot = {partial_transform(Rigid3())};
  result.camera_to_robot[0].observable.fill(false);
  result.camera_to_robot[0].covariance = Matrix6d::Identity();
  save_result(result, folder / "a.yaml");
  EXPECT_THAT(folder.read("a.yaml"), Not(HasSubstr("_m: [")));
  EXPECT_FALSE(load_result(folder / "a.yaml").camera_to_robot.at(0).observable[0]);
}

// ----------------------------------------------------------------------------------------- results of somebody else

const char* const kLeft = "{parent: robot, child: left, translation_m: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1]}";

TEST(ForeignResult, AListAMapOrTransforms) {
  const ResultFile file;
  for (const std::string& text : std::vector<std::string>{
           "- " + std::string(kLeft), "left: " + std::string(kLeft), "transforms:\n  - " + std::string(kLeft),
           "method: theirs\ntransforms:\n  left: " + std::string(kLeft),
           "left: {parent: robot, translation_m: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1]}",
           "[" + std::string(kLeft) + "]"}) {
    const Result result = file.load(text + "\n");
    ASSERT_EQ(result.camera_to_robot.size(), 1U) << text;
    EXPECT_EQ(result.camera_to_robot[0].child, "left");
    EXPECT_EQ(result.camera_to_robot[0].T_parent_child.translation, Eigen::Vector3d(1.0, 2.0, 3.0));
    EXPECT_EQ(result.status, ResultStatus::kSolved);
    EXPECT_FALSE(result.camera_to_robot[0].covariance);
  }
}

TEST(ForeignResult, JsonIsYamlToo) {
  const ResultFile file;
  EXPECT_EQ(file.load(R"([{"parent": "robot", "child": "left", "translation_m": [1, 2, 3],
                           "quaternion_xyzw": [0, 0, 0, 1]}])")
                .camera_to_robot.size(),
            1U);
}

TEST(ForeignResult, AParentThatIsACameraMakesAPair) {
  const ResultFile file;
  const Result result =
      file.load("- " + std::string(kLeft) +
                "\n- {parent: left, child: right, translation_m: [0, 0, 0.5], quaternion_xyzw: [0, 0, 0, 1]}\n");
  EXPECT_EQ(result.camera_to_robot.size(), 1U);
  ASSERT_EQ(result.camera_to_camera.size(), 1U);
  EXPECT_EQ(result.camera_to_camera[0].child, "right");
}

TEST(ForeignResult, StandardDeviationsBecomeACovariance) {
  const ResultFile file;
  const Result result = file.load(
      "left: {parent: robot, translation_m: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1],\n"
      "       stddev: {tx_cm: 1, ty_cm: 2, tz_cm: 3, rx_deg: 0.1, ry_deg: 0.2, rz_deg: 0.3}}\n");
  ASSERT_TRUE(result.camera_to_robot[0].covariance);
  EXPECT_DOUBLE_EQ((*result.camera_to_robot[0].covariance)(1, 1), 4e-4);
  EXPECT_DOUBLE_EQ((*result.camera_to_robot[0].covariance)(5, 5), deg_to_rad(0.3) * deg_to_rad(0.3));
}

// The poses of MC-Calib's cameras are in its first one, which need not stand at zero.
TEST(ForeignResult, McCalibsFileIsAResult) {
  const ResultFile file;
  const auto camera = [](int k, const std::string& data) {
    return "camera_" + std::to_string(k) + ":\n   camera_group: 0\n   camera_pose_matrix: !!opencv-matrix\n" +
           "      rows: 4\n      cols: 4\n      dt: d\n      data: [" + data + "]\n";
  };
  const std::string head = "%YAML:1.0\n---\nnb_camera: 2\n";
  const std::string first = camera(0, "1., 0., 0., 1., 0., 1., 0., 0., 0., 0., 1.,\n         0., 0., 0., 0., 1.");
  const Result result =
      file.load(head + first + camera(1, "0., -1., 0., 1.5, 1., 0., 0., 2.5e-01, 0., 0., 1., 0., 0., 0., 0., 1."));
  ASSERT_EQ(result.camera_to_camera.size(), 1U);
  const EstimatedTransform& pair = result.camera_to_camera[0];
  EXPECT_EQ(pair.parent + " " + pair.child, "camera_0 camera_1");
  EXPECT_LT((pair.T_parent_child.translation - Eigen::Vector3d(0.5, 0.25, 0.0)).norm(), 1e-15);
  EXPECT_LT((pair.T_parent_child.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_THAT(file.problems(head + first), HasSubstr("camera_1"));
  EXPECT_THAT(file.problems(head + first + camera(1, "1, 2, 3")), HasSubstr("camera_1.camera_pose_matrix.data"));
  EXPECT_THAT(file.problems(head + first + camera(1, "2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1")),
              HasSubstr("must be a rotation"));
}

TEST(ForeignResult, EveryKindOfProblemIsNamed) {
  const ResultFile f;
  const auto with = [&](const std::string& entry) { return f.problems("- {" + entry + "}\n"); };
  const std::string pose = "translation_m: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1]";
  EXPECT_EQ(f.problems("- {x-note: mine, parent: robot, child: left, " + pose + "}\n"), "");
  EXPECT_THAT(with("child: left, " + pose), HasSubstr("r.yaml:1: [0].parent: is missing; it must be a frame's name"));
  EXPECT_THAT(with("parent: robot, child: robot, " + pose), HasSubstr("is the parent, too"));
  EXPECT_THAT(with("parent: robot, child: left, translation: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1]"),
              HasSubstr("[0].translation: unknown key; did you mean \"translation_m\"?"));
  EXPECT_THAT(with("parent: robot, child: left, translation_m: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 2]"),
              HasSubstr("has the norm 2; it must be 1 within 0.001, order x y z w"));
  EXPECT_THAT(with("parent: robot, child: left, translation_m: [1, .nan, 3], quaternion_xyzw: [0, 0, 0, 1]"),
              HasSubstr("[0].translation_m[1]: .nan: must be a number"));
  EXPECT_THAT(with("parent: robot, child: left, sentence: pose of robot in left, " + pose),
              HasSubstr("contradicts parent and child, which say \"pose of left in robot\""));
  EXPECT_THAT(f.problems("- " + std::string(kLeft) + "\n- " + kLeft + "\n"),
              HasSubstr("the pose of left in robot is given twice"));
  EXPECT_THAT(f.problems(""), HasSubstr("holds no transform"));
  EXPECT_THAT(f.problems("hello\n"), HasSubstr("must be a list or a map of transforms"));
  EXPECT_THAT(f.problems("left: 5\n"), HasSubstr("left: 5: must be a block of keys"));
  EXPECT_THAT(with("parent: robot, child: left, unobservable: [tx], " + pose), HasSubstr("[0].ty_m: is missing"));
  EXPECT_THAT(with("parent: robot, child: left, unobservable: [x], " + pose),
              HasSubstr("must be a list of tx, ty, tz"));
}

TEST(Result, IsNamedBySettingsThatAreNotTheUsualOnes) {
  EXPECT_EQ(name_with_settings("ml", {}), "ml");
  EXPECT_EQ(name_with_settings("ml", {{"ground", "images"}, {"horizon", "a b/c:d\xff"}}),
            "ml-ground_images-horizon_a_b_c_d_");
  const std::string a = name_with_settings("ml", {{"features", std::string(300, 'x')}});
  const std::string b = name_with_settings("ml", {{"features", std::string(301, 'x')}});
  EXPECT_EQ(a.size(), 80U);
  EXPECT_EQ(b.size(), 80U);
  EXPECT_NE(a, b);
}

TEST(Result, ACovarianceThatIsNoneIsNamed) {
  const ResultFile f;
  const std::string head = "- {parent: r, child: l, translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1], ";
  EXPECT_THAT(f.problems(head + "covariance_m_rad: [[1, 2, 0, 0, 0, 0], [1, 0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0], "
                                "[1, 0], [1]]}\n"),
              HasSubstr("is no covariance"));
  EXPECT_THAT(f.problems(head + "covariance_m_rad: [[1]]}\n"), HasSubstr("must be an upper triangle of 6 rows"));
  EXPECT_THAT(f.problems("format: rigproof-result\nversion: 1\nstatus: solved\njoint_covariance_m_rad: [[1]]\n"),
              HasSubstr("must be an upper triangle of 0 rows"));
}

TEST(Result, LastingErrorsThatDoNotFitAreNamed) {
  const ResultFile f;
  const std::string none = "format: rigproof-result\nversion: 2\nstatus: solved\n";
  const std::string head =
      none +
      "camera_to_robot: [{parent: r, child: l, translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, "
      "1]}]\njoint_covariance_m_rad: [[1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0], [1, 0, 0, 0], [1, 0, "
      "0], [1, 0], [1]]\nlasting_errors:\n  unknowns:\n";
  const auto line = [](const std::string& name, const std::string& covariance, const std::string& with = "0.5") {
    return "  - {camera: left, name: " + name + ", value: 1, with_cameras: [" + with +
           ", 0, 0, 0, 0, 0], covariance: [" + covariance + "]}\n";
  };
  EXPECT_EQ(f.problems(head + line("a", "1, 0") + line("b", "1") + "  stated: [{camera: left, hash: 12}]\n"), "");
  EXPECT_THAT(f.problems(head + line("a", "1")), HasSubstr("must have a line for each camera and board"));
  EXPECT_THAT(f.problems(head + line("a", "1, 2")), HasSubstr("must have rows of an upper triangle, and 6 numbers"));
  EXPECT_THAT(f.problems(head + line("a", "-1")), HasSubstr("variances must be positive"));
  EXPECT_THAT(f.problems(head + line("a", "1, 2") + line("b", "1")), HasSubstr("also of combinations"));
  EXPECT_THAT(f.problems(head + line("a", "1", "1.5")), HasSubstr("together with the cameras'"));
  EXPECT_THAT(f.problems(head + line("a", "1, 0") + line("a", "1")), HasSubstr("twice"));
  EXPECT_THAT(f.problems(head + "  - {camera: left, board: 1, name: a, value: 1, covariance: [1]}\n"),
              HasSubstr("must be of a camera or of a board"));
  EXPECT_THAT(f.problems(head + "  - {camera: left, name: a, covariance: [1]}\n"), HasSubstr("value"));
  EXPECT_THAT(f.problems(head + "  []\n"), HasSubstr("1 to 2000 lines"));
  EXPECT_THAT(f.problems(none + "lasting_errors:\n  unknowns:\n" + line("a", "1")),
              HasSubstr("goes with a joint_covariance_m_rad"));
}

}  // namespace
}  // namespace rigproof
