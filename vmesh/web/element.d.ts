import { VmeshImage } from "./types/viewer/element.js";

export { VmeshImage };

declare global {
  interface HTMLElementTagNameMap {
    "vmesh-image": VmeshImage;
  }
}
