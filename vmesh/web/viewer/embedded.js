/** The bytes that a page holds as text. */

/** @param {Element} element whose text is Base64 */
export function bytesIn(element) {
  const letters = atob(element.textContent.trim());
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}
