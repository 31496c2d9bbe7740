// Scans: a picture, and the commands for chosen options. Surfaces need OpenBLAS, Qhull and SuiteSparse, which the engine does not
// have.
import samples from "samples";
import { enumerator, group, h, select } from "./dom.js";

const TOLERANCES = ["0.001", "0.002", "0.005", "0.01", "0.02"];
const FORMATS = [["step", "STEP"], ["xml", "G+Smo"], ["vtk", "VTK"], ["obj", "OBJ"]];
const PARAMETERS = ["auto", "learned", "shape-preserving", "stretch-minimizing", "isometric"];
const FIRST = { tolerance: "0.005", format: "step", parameters: "auto" };

export function scanTab(app, section) {
  let state = { ...FIRST };
  const change = (changes) => {
    Object.assign(state, changes);
    app.commit();
  };
  const tolerance = select("Tolerance", TOLERANCES.map((value) => [value]), state.tolerance, (value) => change({ tolerance: value }));
  const parameters = select("Parameterization", PARAMETERS.map((value) => [value]), state.parameters, (value) => change({ parameters: value }));
  const format = select("Output", FORMATS, state.format, (value) => change({ format: value }));
  section.append(
    h("div.column", {}, h("img.picture", { src: samples["scan.png"], alt: "A scan of noisy points, the spline surface that batten fits to it, its distances from the points, and the parameters" })),
    h("div.side", {},
      group("Scan", h("p", {}, "The program turns scattered points, in no order and with noise, into a spline surface for CAD."),
        h("p", {}, "It estimates the noise of the points and judges every surface by them, both ways. A surface that the points prove wrong is refused."),
        tolerance.element, parameters.element, format.element,
        h("p.hint", {}, "This room needs OpenBLAS, Qhull and SuiteSparse, which the page leaves out. The commands below run on your computer.")),
    ),
  );
  return {
    state: () => state,
    async restore(next) {
      state = { ...FIRST, ...next };
      tolerance.set(state.tolerance);
      parameters.set(state.parameters);
      format.set(state.format);
    },
    inspect: () => ({ state }),
    commands() {
      const given = state.parameters !== FIRST.parameters;
      return {
        shell: `batten shape scan -o scan.xyz\nbatten surface scan.xyz --tolerance ${state.tolerance} --share 0.95${given ? ` --parameterization ${state.parameters}` : ""} -o scan.${state.format} --picture scan.png`,
        c: `bat_cloud cloud;\nbat_error error;\nbat_cloud_read("scan.xyz", NULL, &cloud, &error);\nbat_surface_options options = bat_surface_reconstruct_defaults();\noptions.fit.tolerance = ${state.tolerance};\noptions.fit.share = 0.95;${given ? `\noptions.parameters = ${enumerator("surface_parameters", state.parameters)};` : ""}\nbat_surface_result result;\nif (bat_surface_reconstruct(&cloud, &options, &result, &error) != BAT_OK)\n    fprintf(stderr, "%s\\n", error.text); // also of a surface that is judged to be wrong\nelse\n    bat_surface_write("scan.${state.format}", &result.surface, NULL, &error);`,
        python: `import batten\nimport numpy as np\n\npoints = np.loadtxt("scan.xyz")\nsurface = batten.fit_surface(points, tolerance=${state.tolerance}, share=0.95${given ? `, parameters="${state.parameters}"` : ""})\nsurface.write("scan.${state.format}")`,
      };
    },
  };
}
