// Every format of `export` is read back by its own parser, and points are where they were.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>
#include <yaml-cpp/yaml.h>

#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>
#include <sstream>

#include "error_text.h"
#include "export_job.h"
#include "paths.h"
#include "pose_near.h"
#include "process.h"
#include "rigproof/core/yaml.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Ten decimals, metres and radians, at a lever of 5 m.
constexpr double kNear = 1e-9;
const Eigen::Vector3d kPoint(0.3, -0.2, 4.0);

// A point of each camera's optical frame is where the result puts it, by way of the frames of the sample's tree.
void expect_points(const TreeOfFrames& tree, const ExportSample& sample) {
  const Rigid3 T_rear = tree.T_robot("rear_link") * sample.T_link_rear;
  EXPECT_LT((tree.T_robot("left_optical_frame") * kPoint - sample.T_robot(0) * kPoint).norm(), kNear);
  EXPECT_LT((tree.T_robot("front_optical_frame") * kPoint - sample.T_robot(1) * kPoint).norm(), kNear);
  EXPECT_LT((T_rear * kPoint - sample.T_robot(2) * kPoint).norm(), kNear);
  EXPECT_EQ(tree.edges.size(), 4U);  // left has a body and an optical frame; the driver publishes that of rear
}

Rigid3 rigid_of(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z), {pose.position.x, pose.position.y, pose.position.z}};
}

TEST(ExportFormats, UrdfIsReadByUrdfdom) {
  const ExportSample sample;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(exported(sample.job(), "urdf"));
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->getRoot()->name, "base_footprint");
  TreeOfFrames tree;
  for (const auto& [name, joint] : model->joints_) {
    EXPECT_EQ(joint->type, urdf::Joint::FIXED) << name;
    tree.add(joint->parent_link_name, joint->child_link_name, rigid_of(joint->parent_to_joint_origin_transform));
  }
  expect_points(tree, sample);
}

// As xacro does it: properties by name, macros with their defaults.
std::string expanded_once(std::string text, const std::map<std::string, std::string>& values) {
  for (const auto& [name, value] : values)
    for (std::size_t at = text.find("${" + name + "}"); at != std::string::npos; at = text.find("${" + name + "}"))
      text.replace(at, name.size() + 3, value);
  return text;
}

std::string between(const std::string& text, const std::string& from, const std::string& to, std::size_t* at) {
  const std::size_t begin = text.find(from, *at);
  if (begin == std::string::npos) return "";
  const std::size_t end = text.find(to, begin + from.size());
  *at = end;
  return text.substr(begin + from.size(), end - begin - from.size());
}

TEST(ExportFormats, XacroHasPropertiesAndMacrosThatMakeTheSameUrdf) {
  const ExportSample sample;
  const std::string text = exported(sample.job(), "xacro");
  std::map<std::string, std::string> properties;
  std::size_t at = 0;
  for (std::string name = between(text, "<xacro:property name=\"", "\"", &at); !name.empty();
       name = between(text, "<xacro:property name=\"", "\"", &at))
    properties[name] = between(text, "value=\"", "\"", &at);
  EXPECT_EQ(properties.size(), 8U);
  std::string urdf = "<robot name=\"r\"><link name=\"base_footprint\"/>";
  at = 0;
  for (std::string parent = between(text, "params=\"parent:=", " ", &at); !parent.empty();
       parent = between(text, "params=\"parent:=", " ", &at)) {
    const std::string child = between(text, "child:=", "\"", &at);
    const std::string body = between(text, ">", "</xacro:macro>", &at);
    urdf += "<link name=\"" + child + "\"/>" +
            expanded_once(expanded_once(body, properties), {{"parent", parent}, {"child", child}});
  }
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(urdf + "</robot>");
  ASSERT_NE(model, nullptr) << urdf;
  TreeOfFrames tree;
  for (const auto& entry : model->joints_)
    tree.add(entry.second->parent_link_name, entry.second->child_link_name,
             rigid_of(entry.second->parent_to_joint_origin_transform));
  expect_points(tree, sample);
}

// static_transform_publisher's arguments: "--x 1 --frame-id a ..".
void add_arguments(const std::vector<std::string>& words, TreeOfFrames* tree) {
  std::map<std::string, std::string> values;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) values[words[i]] = words[i + 1];
  const auto number = [&values](const char* name) { return std::stod(values.at(name)); };
  tree->add(values.at("--frame-id"), values.at("--child-frame-id"),
            Rigid3({number("--qw"), number("--qx"), number("--qy"), number("--qz")},
                   {number("--x"), number("--y"), number("--z")}));
}

// The shell itself says what `ros2` would be called with.
TEST(ExportFormats, StaticTfIsAShellScriptThatPublishesEveryFrame) {
  const ExportSample sample;
  const TempFolder scratch;
  const std::string ros2 =
      scratch.write("ros2", "#!/bin/sh\nfor word in \"$@\"; do printf '%s\\n' \"$word\"; done > \"$0.$$\"\n").string();
  std::filesystem::permissions(ros2, std::filesystem::perms::owner_all);
  const std::string script = scratch.write("tf.sh", exported(sample.job(), "static-tf")).string();
  const ProcessOutput output =
      run_process({"/bin/sh", "-c", "PATH=" + scratch.path().string() + ":$PATH; . " + script});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  TreeOfFrames tree;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path())) {
    if (entry.path().filename().string().rfind("ros2.", 0) != 0) continue;
    std::ifstream stream(entry.path());
    std::vector<std::string> words;
    for (std::string word; std::getline(stream, word);) words.push_back(word);
    ASSERT_EQ(words.size(), 3U + 18U);
    EXPECT_EQ(words[0] + " " + words[1] + " " + words[2], "run tf2_ros static_transform_publisher");
    add_arguments({words.begin() + 3, words.end()}, &tree);
  }
  expect_points(tree, sample);
}

// Python runs it, with modules in the place of ROS that say what they are given.
TEST(ExportFormats, LaunchFileIsRunByPython) {
  const ExportSample sample;
  const TempFolder scratch;
  scratch.write("launch/__init__.py", "def LaunchDescription(nodes): return nodes\n");
  scratch.write("launch_ros/__init__.py", "");
  scratch.write("launch_ros/actions.py",
                "def Node(package, executable, name, arguments):\n"
                "    assert (package, executable) == ('tf2_ros', 'static_transform_publisher'), package\n"
                "    assert name.isidentifier() and all(type(a) is str for a in arguments)\n"
                "    return arguments\n");
  scratch.write("cameras.py", exported(sample.job(), "launch"));
  const ProcessOutput output =
      run_process({"python3", "-c",
                   "import ast, cameras\nast.parse(open('cameras.py').read())\n"
                   "for node in cameras.generate_launch_description(): print('\\t'.join(node))"},
                  scratch.path().string());
  ASSERT_EQ(output.exit_code, 0) << output.err;
  TreeOfFrames tree;
  std::istringstream lines(output.out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::vector<std::string> words;
    for (std::string word; std::getline(fields, word, '\t');) words.push_back(word);
    add_arguments(words, &tree);
  }
  expect_points(tree, sample);
}

Eigen::Matrix4d matrix_of(const YAML::Node& rows) {
  Eigen::Matrix4d matrix;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j].as<double>();
  return matrix;
}

TEST(ExportFormats, KalibrChainsTheCameras) {
  const ExportSample sample;
  const ExportOutput output = write_export(sample.job(), export_format("kalibr"));
  const YAML::Node chain = YAML::Load(output.files[0].text);
  ASSERT_EQ(chain.size(), 3U);
  EXPECT_FALSE(chain["cam0"]["T_cn_cnm1"]);
  for (std::size_t n = 1; n < 3; ++n) {
    // p in camera n-1 > camera n > robot.
    const Rigid3 T = Rigid3::from_matrix(matrix_of(chain["cam" + std::to_string(n)]["T_cn_cnm1"]));
    EXPECT_LT((sample.T_robot(n) * (T * kPoint) - sample.T_robot(n - 1) * kPoint).norm(), kNear);
  }
  EXPECT_EQ(chain["cam0"]["distortion_model"].as<std::string>(), "radtan");
  EXPECT_EQ(chain["cam1"]["distortion_model"].as<std::string>(), "none");
  EXPECT_EQ(chain["cam2"]["distortion_model"].as<std::string>(), "equidistant");
  EXPECT_EQ(chain["cam2"]["distortion_coeffs"].size(), 4U);
  EXPECT_EQ(chain["cam0"]["intrinsics"][0].as<double>(), sample.result.lenses[0].intrinsics.fx_px);
  EXPECT_EQ(chain["cam1"]["resolution"][0].as<int>(), 1280);
  EXPECT_THAT(output.notes, testing::Contains(HasSubstr("Kalibr's radtan has no k3")));
}

// What takes k3's place is as near as the note says, and a lens that needs k3 is refused.
TEST(ExportFormats, KalibrsFourCoefficientsAreNearOrRefused) {
  ExportSample sample;
  const YAML::Node cam0 = YAML::Load(exported(sample.job(), "kalibr"))["cam0"];
  Camera lens = sample.result.lenses[0].intrinsics;
  for (std::size_t i = 0; i < 4; ++i) lens.distortion[i] = cam0["distortion_coeffs"][i].as<double>();
  lens.distortion[4] = 0.0;
  EXPECT_LT(largest_pixel_difference(sample.result.lenses[0].intrinsics, lens), 0.05);
  sample.result.lenses[0].intrinsics.distortion = {0.0, 0.0, 0.0, 0.0, 0.4};
  EXPECT_THAT(error_text([&] { exported(sample.job(), "kalibr"); }),
              AllOf(HasSubstr("left"), HasSubstr("no k3 (0.4)"), HasSubstr("opencv and json hold this lens")));
}

cv::Mat read_matrix(const cv::FileNode& node) {
  cv::Mat matrix;
  node >> matrix;
  return matrix;
}

TEST(ExportFormats, OpenCvIsReadByFileStorage) {
  const ExportSample sample;
  const cv::FileStorage storage(exported(sample.job(), "opencv"), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  const cv::FileNode cameras = storage["cameras"];
  ASSERT_EQ(cameras.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(static_cast<std::string>(cameras[i]["name"]), sample.result.camera_to_robot[at].child);
    const cv::Mat T = read_matrix(cameras[i]["T_parent_camera"]);
    const cv::Mat p = T * (cv::Mat_<double>(4, 1) << kPoint.x(), kPoint.y(), kPoint.z(), 1.0);
    EXPECT_LT((Eigen::Vector3d(p.at<double>(0), p.at<double>(1), p.at<double>(2)) - sample.T_robot(at) * kPoint).norm(),
              kNear);
  }
  const cv::Mat K = read_matrix(cameras[0]["camera_matrix"]);
  EXPECT_DOUBLE_EQ(K.at<double>(0, 0), sample.result.lenses[0].intrinsics.fx_px);
  EXPECT_DOUBLE_EQ(read_matrix(cameras[0]["distortion_coefficients"]).at<double>(4), 0.001);
  EXPECT_EQ(static_cast<std::string>(cameras[2]["distortion_model"]), "fisheye");
  EXPECT_EQ(read_matrix(cameras[2]["distortion_coefficients"]).cols, 4);
}

TEST(ExportFormats, CameraInfoOfEachCameraIsAFileThatRosReads) {
  const ExportSample sample;
  const ExportOutput output = write_export(sample.job(), export_format("camera_info"));
  ASSERT_EQ(output.files.size(), 3U);
  EXPECT_EQ(output.files[2].name, "rear.yaml");
  for (std::size_t i = 0; i < 3; ++i) {
    const YAML::Node info = YAML::Load(output.files[i].text);
    const Camera lens = i == 0 ? sample.result.lenses[0].intrinsics : sample.rig.cameras[i].camera;
    EXPECT_EQ(info["image_width"].as<int>(), lens.width_px);
    EXPECT_EQ(info["camera_matrix"]["data"][2].as<double>(), lens.cx_px);
    EXPECT_EQ(info["projection_matrix"]["data"][6].as<double>(), lens.cy_px);
    EXPECT_EQ(info["distortion_coefficients"]["data"][0].as<double>(), lens.distortion[0]);
    EXPECT_EQ(info["distortion_coefficients"]["cols"].as<std::size_t>(),
              info["distortion_coefficients"]["data"].size());
    EXPECT_EQ(info["distortion_model"].as<std::string>(), i == 2 ? "equidistant" : "plumb_bob");
  }
}

TEST(ExportFormats, MatrixIsFourRowsForEachCamera) {
  const ExportSample sample;
  std::istringstream lines(exported(sample.job(), "matrix"));
  std::vector<double> numbers;
  for (std::string line; std::getline(lines, line);) {
    if (line.front() == '#') continue;
    std::istringstream row(line);
    for (double number = 0.0; row >> number;) numbers.push_back(number);
  }
  ASSERT_EQ(numbers.size(), 48U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(numbers.data() + 16 * i);
    EXPECT_LT(((T * kPoint.homogeneous()).head<3>() - sample.T_robot(i) * kPoint).norm(), 1e-14);
  }
}

TEST(ExportFormats, JsonHoldsPosesTreeAndLenses) {
  const ExportSample sample;
  const YamlTree tree = parse_yaml(exported(sample.job(), "json"), "export.json");
  EXPECT_EQ(tree.find("format")->scalar, "rigproof-export");
  EXPECT_EQ(tree.find("date")->scalar, "2030-01-02");
  EXPECT_EQ(tree.find("tree")->items.size(), 4U);
  const YamlTree& left = tree.find("cameras")->items[0];
  EXPECT_EQ(left.find("intrinsics_are")->scalar, "estimated");
  EXPECT_EQ(left.find("told_intrinsics")->find("fx_px")->scalar, number_text(sample.rig.cameras[0].camera.fx_px));
  EXPECT_EQ(left.find("pose")->find("sigma")->find("tx_m")->scalar, "0.001");
  EXPECT_EQ(tree.find("cameras")->items[1].find("intrinsics_are")->scalar, "told");
}

// Where it is from, how sure it is, which lens goes with it: in every format that has comments, and in JSON.
TEST(ExportFormats, EveryFormatSaysWhereItIsFromAndWhichLensItNeeds) {
  const ExportSample sample;
  for (const ExportFormat& format : export_formats())
    EXPECT_THAT(write_export(sample.job(), format).files.at(0).text,
                AllOf(HasSubstr("2030-01-02"), HasSubstr("monday/results/ml.yaml"),
                      HasSubstr("one sigma x 0.1, y 0.1, z 0.1 cm; about x 0.057"), HasSubstr("-m ml:told=exact"),
                      HasSubstr("px from those of rig.yaml"),
                      HasSubstr("front: the pose goes with the intrinsics of rig.yaml")))
        << format.name;
}

// Two hyphens, quotes and line feeds of a name do not leave its comment, attribute or word.
TEST(ExportFormats, NamesCannotBreakOut) {
  ExportSample sample;
  sample.rig.cameras[0].link = "a'\"<&--> b;\\";
  ExportOptions options;
  options.warnings = {"--> <!-- a warning\nwith a line feed"};
  const ExportJob job = sample.job(options);
  ASSERT_NE(urdf::parseURDF(exported(job, "urdf")), nullptr);
  const TempFolder scratch;
  scratch.write("cameras.py", exported(job, "launch"));
  const ProcessOutput python =
      run_process({"python3", "-c", "import ast; ast.parse(open('cameras.py').read())"}, scratch.path().string());
  EXPECT_EQ(python.exit_code, 0) << python.err;
  scratch.write("tf.sh", exported(job, "static-tf"));
  EXPECT_EQ(run_process({"/bin/sh", "-n", "tf.sh"}, scratch.path().string()).exit_code, 0);
  EXPECT_THAT(exported(job, "static-tf"), HasSubstr("--child-frame-id 'a'\\''\"<&--> b;\\'"));
}

// ------------------------------------------------------------------------------------------------- what is exported

TEST(ExportJobs, PartialResultsNeedAWordAndGiveOnlyWhatIsKnown) {
  ExportSample sample;
  sample.result.status = ResultStatus::kPartial;
  sample.result.camera_to_robot[0].observable = {false, false, true, true, true, false};
  EXPECT_THAT(error_text([&] { sample.job(); }),
              AllOf(HasSubstr("is partial, unknown are left: tx, ty, rz"), HasSubstr("--partial")));
  ExportOptions options;
  options.partial = true;
  const ExportJob job = sample.job(options);
  EXPECT_THAT(exported(job, "urdf"),
              AllOf(Not(HasSubstr("left_link")), HasSubstr("rear_link"), HasSubstr("left: left out")));
  const YamlTree pose = *parse_yaml(exported(job, "json"), "x").find("cameras")->items[0].find("pose");
  EXPECT_EQ(pose.find("tx_m"), nullptr);
  EXPECT_EQ(pose.find("translation_m"), nullptr);
  EXPECT_EQ(pose.find("tz_m")->scalar, number_text(sample.T_robot(0).translation.z()));
  EXPECT_NE(pose.find("pitch_rad"), nullptr);
  // Between cameras all is known.
  EXPECT_EQ(YAML::Load(exported(job, "kalibr")).size(), 3U);
}

TEST(ExportJobs, RefusedResultsHaveNothing) {
  ExportSample sample;
  sample.result.status = ResultStatus::kRefused;
  sample.result.camera_to_robot.clear();
  ExportOptions options;
  options.partial = true;
  try {
    sample.job(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kRefused);
    EXPECT_THAT(error.what(), HasSubstr("is refused and holds no pose"));
  }
}

TEST(ExportJobs, AllUnknownCamerasAreNamedAtOnce) {
  const ExportSample sample;
  ExportOptions options;
  options.cameras = {"frnt"};
  options.joints = {{"raer", "a"}};
  EXPECT_THAT(error_text([&] { sample.job(options); }),
              AllOf(HasSubstr("--camera: frnt"), HasSubstr("did you mean \"front\"?"), HasSubstr("--joint: raer"),
                    HasSubstr("did you mean \"rear\"?")));
}

TEST(ExportJobs, NoFrameGetsTwoParents) {
  ExportSample sample;
  sample.rig.cameras[1].link = "left_link";
  EXPECT_THAT(error_text([&] { exported(sample.job(), "launch"); }),
              AllOf(HasSubstr("front: left_link"), HasSubstr("two parents"), HasSubstr("left")));
  sample.rig.cameras[1].link = "base_footprint";
  EXPECT_THAT(error_text([&] { exported(sample.job(), "urdf"); }), HasSubstr("above and below base_footprint"));
}

TEST(ExportJobs, IntrinsicsAreNeededWhereTheyAreWritten) {
  ExportSample sample;
  sample.rig = {};
  EXPECT_THAT(error_text([&] { exported(sample.job(), "opencv"); }),
              AllOf(HasSubstr("front"), HasSubstr("rear"), HasSubstr("--rig"), Not(HasSubstr("left"))));
  EXPECT_THAT(exported(sample.job(), "matrix"), HasSubstr("no rig is at hand"));
}

// What a person says prevails over the rig.
TEST(ExportJobs, OptionsPrevailOverTheRig) {
  const ExportSample sample;
  ExportOptions options;
  options.cameras = {"rear"};
  options.links = {{"rear", "mast"}};
  options.optical_frames = {{"rear", "mast_eye"}};
  const std::vector<TreeTransform> tree = tree_transforms(sample.job(options));
  ASSERT_EQ(tree.size(), 2U);
  EXPECT_EQ(tree[0].child, "mast");
  EXPECT_EQ(tree[1].child, "mast_eye");
  EXPECT_FALSE(tree[1].is_estimated);
  options.optical_frames.clear();
  options.T_link_camera = {{"rear", Rigid3(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0})}};
  const std::vector<TreeTransform> told = tree_transforms(sample.job(options));
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(IsPoseNear(sample.T_robot(2), told[0].T_parent_child * options.T_link_camera.at("rear"), 1e-12, 1e-12));
}

// Of a bag's tree nothing is asked again: the joint is the one of the robot's own tree, into the mount link.
TEST(ExportJobs, TheRigKnowsTheRobotsFrames) {
  ExportSample sample;
  const Rigid3 T_robot_base(Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.13});
  RigCamera& left = sample.rig.cameras[0];
  left.optical_frame = "left_eye";
  left.T_link_camera = sample.T_link_rear;
  sample.rig.tf_static.add("base_footprint", "base_link", T_robot_base);
  sample.rig.tf_static.add("base_link", "left_link", Rigid3());
  ExportOptions options;
  options.cameras = {"left"};
  const std::vector<TreeTransform> tree = tree_transforms(sample.job(options));
  ASSERT_EQ(tree.size(), 1U);
  EXPECT_EQ(tree[0].parent, "base_link");
  EXPECT_EQ(tree[0].child, "left_link");
  EXPECT_TRUE(IsPoseNear(sample.T_robot(0), T_robot_base * tree[0].T_parent_child * sample.T_link_rear, 1e-12, 1e-12));
  EXPECT_THAT(exported(sample.job(options), "static-tf"),
              AllOf(HasSubstr("left_link is placed so that left_eye, at "), HasSubstr("it hangs on base_link")));

  options.parent = "footprint";
  const std::vector<TreeTransform> below = tree_transforms(sample.job(options));
  EXPECT_EQ(below[0].parent, "footprint");
  EXPECT_TRUE(IsPoseNear(sample.T_robot(0), below[0].T_parent_child * sample.T_link_rear, 1e-12, 1e-12));
}

// Heights are counted from the ground, whatever the frame is called.
TEST(ExportJobs, AParentOfTheRobotsTreeIsWhereTheTreeHasIt) {
  ExportSample sample;
  const Rigid3 T_ground_base(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())), {0.2, 0.0, 0.13});
  sample.rig.tf_static.add("base_footprint", "base_link", T_ground_base);
  ExportOptions options;
  options.parent = "base_link";
  const ExportJob job = sample.job(options);
  EXPECT_EQ(job.cameras[0].estimate.parent, "base_link");
  EXPECT_TRUE(IsPoseNear(sample.T_robot(0), T_ground_base * job.cameras[0].estimate.T_parent_child, 1e-12, 1e-12));
  EXPECT_THAT(exported(job, "matrix"), HasSubstr("at 20, 0, 13 cm in base_footprint"));
  // A recording that calls base_link its robot frame has its point on the ground all the same.
  for (EstimatedTransform& estimate : sample.result.camera_to_robot) estimate.parent = "base_link";
  const ExportJob own = sample.job();
  EXPECT_NEAR(own.cameras[0].estimate.T_parent_child.translation.z(), sample.T_robot(0).translation.z() - 0.13, 1e-12);
  EXPECT_NEAR(own.cameras[0].estimate.T_parent_child.translation.x(), sample.T_robot(0).translation.x(), 1e-12);
  EXPECT_THAT(remarks_of(own), Contains(HasSubstr("base_link, 13 cm above base_footprint")));
}

TEST(ExportJobs, AParentWhoseHeightNobodyKnowsIsSaid) {
  ExportSample sample;
  ExportOptions options;
  sample.rig.tf_static.add("base_link", "left_link", Rigid3());
  EXPECT_THAT(remarks_of(sample.job()),
              Contains(AllOf(HasSubstr("hangs left_link below base_link, which nothing joins with base_footprint"),
                             HasSubstr("`--parent base_link --parent-height-mm H`"))));
  options.parent = "base_link";
  EXPECT_THAT(
      remarks_of(sample.job(options)),
      Contains(AllOf(HasSubstr("base_link is taken to be what the result calls"), HasSubstr("--parent-height-mm"))));
  options.parent_height_m = 0.1;
  const ExportJob job = sample.job(options);
  EXPECT_EQ(job.cameras[0].estimate.parent, "base_link");
  EXPECT_NEAR(job.cameras[0].estimate.T_parent_child.translation.z(), sample.T_robot(0).translation.z() - 0.1, 1e-12);
  EXPECT_THAT(remarks_of(job), Contains(HasSubstr("base_link, 10 cm above the ground")));
}

// What the rig says of its own link is not taken for that of another.
TEST(ExportJobs, AnotherLinkForgetsWhatTheRigSaysOfItsOwn) {
  ExportSample sample;
  sample.rig.cameras[0].optical_frame = "left_eye";
  sample.rig.cameras[0].T_link_camera = sample.T_link_rear;
  ExportOptions options;
  options.cameras = {"left"};
  options.links = {{"left", "mast"}};
  const std::vector<TreeTransform> tree = tree_transforms(sample.job(options));
  ASSERT_EQ(tree.size(), 2U);
  EXPECT_EQ(tree[0].child, "mast");
  EXPECT_EQ(tree[1].child, "left_eye");
  EXPECT_TRUE(IsPoseNear(sample.T_robot(0), tree[0].T_parent_child * tree[1].T_parent_child, 1e-12, 1e-12));
  options.links = {{"left", "left_eye"}};
  const std::vector<TreeTransform> optical = tree_transforms(sample.job(options));
  ASSERT_EQ(optical.size(), 1U);
  EXPECT_TRUE(IsPoseNear(sample.T_robot(0), optical[0].T_parent_child, 1e-12, 1e-12));
}

// ------------------------------------------------------------------------------------------------- files

TEST(ExportFiles, WhatWasThereIsKeptWithItsPermissions) {
  const TempFolder scratch;
  const std::filesystem::path file = scratch.write("a.urdf", "old");
  std::filesystem::permissions(file, std::filesystem::perms(0640));
  const WrittenFile written = write_with_backup(file, "new");
  EXPECT_EQ(scratch.read("a.urdf"), "new");
  EXPECT_EQ(scratch.read("a.urdf.bak"), "old");
  EXPECT_EQ(written.backup, file.string() + ".bak");
  EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0640));
  // The same again leaves the only copy of what was there.
  EXPECT_FALSE(write_with_backup(file, "new").changed);
  EXPECT_EQ(scratch.read("a.urdf.bak"), "old");
}

TEST(ExportFiles, LinksAndReadOnlyFilesAreRefused) {
  const TempFolder scratch;
  const std::filesystem::path file = scratch.write("a", "old");
  std::filesystem::create_symlink("a", scratch / "link");
  EXPECT_THAT(error_text([&] { write_with_backup(scratch / "link", "new"); }), HasSubstr("it is a link"));
  std::filesystem::permissions(file, std::filesystem::perms(0444));
  EXPECT_THAT(error_text([&] { write_with_backup(file, "new"); }), HasSubstr("read-only"));
  EXPECT_EQ(scratch.read("a"), "old");
  // The same is known before there is a text.
  EXPECT_THAT(error_text([&] { check_can_be_written(scratch / "link"); }), HasSubstr("it is a link"));
  EXPECT_THAT(error_text([&] { check_can_be_written(file); }), HasSubstr("read-only"));
  EXPECT_THAT(error_text([&] { check_can_be_written(scratch.path()); }), HasSubstr("there is a folder of this name"));
  EXPECT_THAT(error_text([&] { check_can_be_written(file / "deeper/b"); }), HasSubstr("is no folder"));
  for (const std::filesystem::path& good :
       {scratch / "new", scratch / "not/yet/there", std::filesystem::path("/dev/null")})
    EXPECT_NO_THROW(check_can_be_written(good)) << good;
  EXPECT_FALSE(std::filesystem::exists(scratch / "not"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.bak"));
}

}  // namespace
}  // namespace rigproof
