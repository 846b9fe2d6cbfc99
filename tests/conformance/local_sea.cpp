#include "tests/conformance/local_sea.hpp"

#include <fmt/format.h>

#include <bit>
#include <map>

namespace trochoid::conformance {

namespace {

using Fields = std::vector<std::shared_ptr<const LandField>>;

Fields fields_of(const InterestState& state) {
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, value] : state.blocks) {
        auto& field = fields[key.field];
        if (!field) field = std::make_shared<LandField>(key.field, value.step_log2);
        if (field->step_log2() == value.step_log2 && field->fits(key.block)) field->set(value.block);
    }
    Fields all;
    for (auto& [id, field] : fields) all.push_back(std::move(field));
    return all;
}

}  // namespace

Sea local_sea(const InterestState& state) {
    const Fields fields = fields_of(state);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, box] : state.boxes) boxes.push_back(prepare(*box, fields));
    return Sea(std::move(boxes));
}

Sea local_sea(const InterestState& state, const PatchDescriptor& patch) {
    const Fields fields = fields_of(state);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const PatchBox& entry : patch.boxes) {
        WaveTrainBox box = *state.boxes.at(entry.box);
        box.trains.resize(entry.train_count);
        boxes.push_back(prepare(std::move(box), fields));
    }
    return Sea(std::move(boxes));
}

std::string difference_of(const SurfaceSample& theirs, const SurfaceSample& ours) {
    const std::pair<const char*, float SurfaceSample::*> parts[] = {
        {"ax", &SurfaceSample::ax},   {"ay", &SurfaceSample::ay},   {"az", &SurfaceSample::az},
        {"pxx", &SurfaceSample::pxx}, {"pxz", &SurfaceSample::pxz}, {"pzx", &SurfaceSample::pzx},
        {"pzz", &SurfaceSample::pzz}, {"yx", &SurfaceSample::yx},   {"yz", &SurfaceSample::yz},
        {"nx", &SurfaceSample::nx},   {"ny", &SurfaceSample::ny},   {"nz", &SurfaceSample::nz},
        {"vx", &SurfaceSample::vx},   {"vy", &SurfaceSample::vy},   {"vz", &SurfaceSample::vz}};
    std::string text;
    for (const auto& [name, part] : parts) {
        const auto a = std::bit_cast<uint32_t>(theirs.*part);
        const auto b = std::bit_cast<uint32_t>(ours.*part);
        if (a != b)
            text += fmt::format("{}{} {:08x} instead of {:08x}", text.empty() ? "" : ", ", name, a, b);
    }
    return text;
}

}  // namespace trochoid::conformance
