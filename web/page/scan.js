// Scans: a picture and the command line. Surfaces need LAPACK, Qhull and SuiteSparse, which the engine does not have.
import samples from "samples";
import { group, h } from "./dom.js";

export function scanTab(app, section) {
  section.append(
    h("div.column", {}, h("img.picture", { src: samples["scan.jpg"] ?? samples["scan.png"], alt: "A scan of 6,000 noisy points beside the spline surface that batten fits to it" })),
    h("div.side", {},
      group("Scan", h("p", {}, "The program turns scattered points, in no order and with noise, into a spline surface for CAD: STEP, G+Smo or a mesh."), h("p.hint", {}, "This room needs LAPACK, Qhull and SuiteSparse, which the page leaves out. The commands below run on your computer.")),
    ),
  );
  return {
    state: () => ({}),
    restore: async () => {},
    inspect: () => ({}),
    commands: () => ({
      shell: "batten shape scan --vertices 6000 -o scan.xyz\nbatten surface scan.xyz --functions 600 -o scan.step --picture scan.png",
      c: 'bat_cloud cloud;\nbat_error error;\nbat_cloud_read("scan.xyz", NULL, &cloud, &error);\nbat_surface_result result;\nif (bat_surface_reconstruct(&cloud, NULL, &result, &error) != BAT_OK)\n    fprintf(stderr, "%s\\n", error.text);',
      python: 'import batten\n\nsurface = batten.fit_surface(points, functions=600)\nsurface.to_step("scan.step")',
    }),
  };
}
