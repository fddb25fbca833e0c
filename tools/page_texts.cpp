#include "page_texts.h"

#include <map>
#include <stdexcept>

namespace tufa::tools {

const PageText& pageText(const std::string& subcommand) {
  static const std::map<std::string, PageText> kTexts = {
      {"make",
       {"Writes a demonstration volume: a level set or a fog volume of a shape whose surface is "
        "known.",
        {{"tufa make bracket -o bracket.vdb --voxel 0.01", "a mechanical part with sharp edges"}}}},
      {"voxelize",
       {"Converts a closed mesh to a level set, or to a fog volume. OpenVDB decides what is "
        "inside.",
        {{"tufa voxelize part.stl -o part.vdb --voxel 0.5", "voxels of half a unit of the mesh"}}}},
      {"model",
       {"Samples a scene of formulas, in JSON, where its bounds cannot leave the surface out.",
        {{"tufa model part.json -o part.vdb --voxel 0.5", "a level set of the scene"},
         {"tufa model part.json --at 1,0,2.5", "what the scene is at a point"}}}},
      {"import",
       {"Converts a stack of images to a volume: raw values or, where the command was built with "
        "ITK, "
        "DICOM, NIfTI, NRRD, MetaImage, TIFF and PNG.",
        {{"tufa import ct_folder -o head.vdb", "a DICOM series"},
         {"tufa import head.raw -o head.vdb --size 64,64,93 --type u16", "raw values"}}}},
      {"picture",
       {"Takes a picture of a volume or a scene by ray casting, without a mesh.",
        {{"tufa picture head.vdb -o bone.png --iso 1150", "the surface at a value"},
         {"tufa picture part.vdb --compare part.ply", "how much of a mesh looks different"}}}},
      {"info",
       {"Says what the grids of a file are, how large they are, and whether they can be meshed.",
        {{"tufa info smoke.vdb", "all grids of a file"}}}},
      {"advise",
       {"Says, before anything is meshed, whether a grid is fine enough for the features of its "
        "surface, and what voxel size it would take.",
        {{"tufa advise scan.vdb --iso 1150", "the thickness of solid and gaps, in voxels"}}}},
      {"filter",
       {"Filters a volume, as tufa mesh, tufa lod and tufa chunks do before they mesh, and writes "
        "it.",
        {{"tufa filter scan.vdb -o clean.vdb --iso 1150 --smooth gaussian --keep-largest 1",
          "smoothed, and of its largest component alone"}}}},
      {"mesh",
       {"Meshes the surface of a volume at a value. The mesh is adaptive, closed, 2-manifold and "
        "within the tolerance of the uniform mesh, which its report certifies.",
        {{"tufa mesh part.vdb -o part.ply --check", "a level set, checked"},
         {"tufa mesh scan.vdb -o bone.stl --iso 1150 --smooth gaussian --keep-largest 1",
          "smoothed, and of its largest component alone"},
         {"tufa mesh rooms.vdb -o rooms.glb --grid '*' --join union",
          "all level sets as one surface"},
         {"tufa mesh 'smoke.####.vdb' -o 'smoke.####.glb' --iso 0.05 --frames 1-240 --jobs 4",
          "a sequence, a process a frame"}}}},
      {"lod",
       {"Makes levels of detail of one surface, each with a certified error, in one file or a file "
        "each.",
        {{"tufa lod part.vdb -o part.glb --compress", "one .glb that engines read"},
         {"tufa lod part.vdb -o 'part_{}.ply' --triangles 5000,1000,200",
          "by numbers of triangles"}}}},
      {"chunks",
       {"Divides a surface into cubes, each at several levels of detail, with strips between them, "
        "so "
        "that chunks at different levels meet without cracks.",
        {{"tufa chunks terrain.vdb -o terrain --chunk 32", "a folder with chunks.json"},
         {"tufa chunks --assemble terrain --lods camera:0,0,5 -o seen.ply --check",
          "what a camera sees, as one mesh"}}}},
      {"check",
       {"Says whether meshes are watertight: closed, manifold and oriented; and counts what "
        "intersects, by exact predicates of CGAL.",
        {{"tufa check part.ply --against part.vdb",
          "with the distance to the surface of a grid"}}}},
      {"fit",
       {"Describes a closed mesh by blobs, as a scene of metaballs.",
        {{"tufa fit spot.obj -o spot.json --blobs 200", "200 metaballs for a mesh"},
         {"tufa fit spot.obj -o spot.json --blobs 1000 --error 0.005",
          "as many as it takes to half a percent of the diagonal"}}}},
      {"repair",
       {"Repairs the mesh of another program by CGAL, and says what cannot be repaired.",
        {{"tufa repair scan.stl -o scan.ply --merge 0.001 --fill 30",
          "merges vertices and fills small holes"}}}},
      {"compare",
       {"Meshes a volume by every method and by OpenVDB's volumeToMesh, and measures each.",
        {{"tufa compare part.vdb -o report.html", "a page with pictures"}}}},
      {"help",
       {"Prints the options of a subcommand.", {{"tufa help mesh", "those of tufa mesh"}}}}};
  const auto text = kTexts.find(subcommand);
  if (text == kTexts.end()) {
    throw std::logic_error("tools/page_texts.cpp has no text for tufa " + subcommand);
  }
  return text->second;
}

}  // namespace tufa::tools
